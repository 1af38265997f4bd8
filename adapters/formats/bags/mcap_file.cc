// SPDX-License-Identifier: Apache-2.0
// MCAP: records of a byte that says what they are, eight bytes of length and their content, all
// little-endian (mcap.dev/spec). The messages lie in chunks, which may be compressed.

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/bags/decompression.h"
#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 30;
enum McapRecord : unsigned char {
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMetadata = 12,
  kMcapDataEnd = 15
};

/// Reads little-endian numbers and texts; `good` turns false at the end.
struct McapReader {
  std::string_view bytes;
  std::size_t at = 0;
  bool good = true;

  std::uint64_t number(std::size_t size) {
    if (size > bytes.size() - at) {
      good = false;
      at = bytes.size();
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    }
    at += size;
    return value;
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes.size() - at) {
      good = false;
      at = bytes.size();
      return {};
    }
    const std::string_view out = bytes.substr(at, size);
    at += size;
    return out;
  }
  std::string text() { return std::string(take(number(4))); }
};

Compression compression_named(const std::string& path, const std::string& name) {
  if (name.empty()) return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  throw InputError(path + ": chunks compressed by '" + name + "'; expected none, lz4 or zstd");
}

/// The records of a chunk, from its content.
std::string chunk_records(const std::string& path, std::string_view content) {
  McapReader chunk{content};
  chunk.number(8);  // first and last time
  chunk.number(8);
  const std::uint64_t size = chunk.number(8), crc = chunk.number(4);
  const std::string compression = chunk.text();
  const std::string_view records = chunk.take(chunk.number(8));
  // What says that it is much larger than it can be would only fill memory.
  if (!chunk.good || size > kLargestChunk || size / 1000 > records.size() + (1 << 16)) {
    throw InputError(path + ": a damaged chunk; expected an intact file");
  }
  std::string out =
      decompressed(compression_named(path, compression), records, size, path + ": a chunk");
  if (out.size() != size ||
      (crc != 0 && crc != ::crc32(0, reinterpret_cast<const Bytef*>(out.data()),
                                  static_cast<uInt>(out.size())))) {
    throw InputError(path + ": a chunk has a wrong checksum; expected an intact file");
  }
  return out;
}

}  // namespace

McapFile::McapFile(const BagPart& part, std::vector<BagTopic>& topics,
                   std::vector<std::string>& notes)
    : path_(part.name), in_(part.path, std::ios::binary | std::ios::ate) {
  const std::string& path = path_;
  const std::size_t file = part.number;
  std::ifstream& in = in_;
  const auto whole = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in.tellg()));
  in.seekg(0);
  std::string magic(kMcapMagic.size(), '\0');
  in.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (!in || magic != kMcapMagic) throw InputError(path + ": no MCAP file; expected one");
  std::map<std::uint64_t, std::string> schemas;
  struct Channel {
    std::string topic, type, encoding;
  };
  std::map<std::uint64_t, Channel> channels;
  // `chunk` 0: not in one; `base`: where the record's content begins, in the file or the chunk.
  const auto take = [&](unsigned char kind, std::string_view content, std::size_t chunk,
                        std::size_t base) {
    McapReader r{content};
    if (kind == kMcapSchema) {
      const std::uint64_t id = r.number(2);
      schemas[id] = r.text();
    } else if (kind == kMcapChannel) {
      const std::uint64_t id = r.number(2), schema = r.number(2);
      const std::string topic = r.text();
      const Channel& channel = channels[id] = {topic, schemas[schema], r.text()};
      // Also one that nothing was recorded of: who asks for it is told so.
      if (r.good) topic_named(topics, path, channel.topic, channel.type, channel.encoding);
    } else if (kind == kMcapMessage) {
      const std::uint64_t id = r.number(2);
      r.number(4);
      const auto time = static_cast<std::int64_t>(r.number(8));
      r.number(8);
      const auto channel = channels.find(id);
      if (!r.good || channel == channels.end()) {
        throw InputError(path + ": a message of no channel; expected an intact file");
      }
      topic_named(topics, path, channel->second.topic, channel->second.type,
                  channel->second.encoding)
          .messages.push_back({time, file, chunk, base + r.at, content.size() - r.at});
      return;
    } else if (kind == kMcapMetadata) {
      const std::string name = r.text();
      McapReader fields{r.take(r.number(4))};
      BagFile::Fields& entries = metadata_[name];
      entries.clear();
      while (fields.good && fields.at < fields.bytes.size()) {
        const std::string key = fields.text();
        entries[key] = fields.text();
      }
      r.good = r.good && fields.good;
    } else {
      return;
    }
    if (!r.good) throw InputError(path + ": a damaged record; expected an intact file");
  };
  std::uint64_t at = magic.size();
  bool ended = false;
  while (!ended && at + 9 <= whole) {
    std::string head(9, '\0');
    in.seekg(static_cast<std::streamoff>(at));
    in.read(head.data(), 9);
    const auto kind = static_cast<unsigned char>(head[0]);
    McapReader r{std::string_view(head).substr(1)};
    const std::uint64_t size = r.number(8);
    if (!in || size > whole - at - 9) break;
    const std::uint64_t content = at + 9;
    at = content + size;
    ended = kind == kMcapDataEnd;
    if (kind != kMcapSchema && kind != kMcapChannel && kind != kMcapMessage && kind != kMcapChunk &&
        kind != kMcapMetadata) {
      continue;
    }
    if (size > kLargestChunk) {
      throw InputError(path + ": a record of " + std::to_string(size) +
                       " bytes; expected at most 1 GB");
    }
    std::string bytes(size, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    if (!in) break;
    if (kind != kMcapChunk) {
      take(kind, bytes, 0, content);
      continue;
    }
    const std::string records = chunk_records(path, bytes);
    McapReader inside{records};
    while (inside.at < records.size()) {
      const auto inner = static_cast<unsigned char>(inside.number(1));
      const std::uint64_t length = inside.number(8);
      const std::size_t begin = inside.at;
      const std::string_view record = inside.take(length);
      if (!inside.good) throw InputError(path + ": a damaged chunk; expected an intact file");
      take(inner, record, content, begin);
    }
  }
  if (!ended)
    notes.push_back(path + ": ends early, as of a recorder that was stopped; read so far");
}

std::string McapFile::bytes(std::uint64_t offset, std::size_t size) {
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset));
  std::string bytes(size, '\0');
  in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in_) throw InputError(path_ + ": cannot be read; expected it as it was");
  return bytes;
}

std::string McapFile::chunk(std::uint64_t offset) {
  const std::string head = bytes(offset - 8, 8);
  McapReader r{head};
  return chunk_records(path_, bytes(offset, std::min(r.number(8), kLargestChunk)));
}

std::string McapFile::read(const BagTopic::Message& message) {
  if (message.chunk == 0) return bytes(message.begin, message.size);
  if (cached_ != message.chunk) {
    cache_ = chunk(message.chunk);
    cached_ = message.chunk;
  }
  if (message.begin + message.size > cache_.size()) {
    throw InputError(path_ + ": cannot be read; expected it as it was");
  }
  return cache_.substr(message.begin, message.size);
}

}  // namespace prospect
