// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#ifdef PROSPECT_WITH_ZSTD
#include <zstd.h>
#endif

#include "models/version.h"

namespace prospect {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";

enum Opcode : unsigned char {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// Little-endian numbers, texts with their length before them.
class Bytes {
 public:
  Bytes& u16(std::uint64_t value) { return number(value, 2); }
  Bytes& u32(std::uint64_t value) { return number(value, 4); }
  Bytes& u64(std::uint64_t value) { return number(value, 8); }
  Bytes& u8(std::uint64_t value) { return number(value, 1); }
  Bytes& text(std::string_view text) { return u32(text.size()).raw(text); }
  Bytes& raw(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
  }
  Bytes& fields(const McapWriter::Fields& fields) {
    Bytes all;
    for (const auto& [name, value] : fields) all.text(name).text(value);
    return text(all.bytes_);
  }
  const std::string& str() const { return bytes_; }

 private:
  Bytes& number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 255);
    return *this;
  }
  std::string bytes_;
};

std::string record(Opcode opcode, const Bytes& content) {
  return Bytes().u8(opcode).u64(content.str().size()).raw(content.str()).str();
}

std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// What is stored of a chunk's records, and what it is compressed by.
std::pair<std::string, std::string> compressed(const std::string& records, int level) {
#ifdef PROSPECT_WITH_ZSTD
  std::string out(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), records.data(), records.size(), level);
  if (!ZSTD_isError(size)) {
    out.resize(size);
    return {std::move(out), "zstd"};
  }
#else
  static_cast<void>(level);
#endif
  return {records, ""};
}

}  // namespace

McapWriter::McapWriter(const std::string& path, McapWriterOptions options)
    : file_(path), options_(std::move(options)) {
  if (!file_.is_open()) {
    error_ = std::strerror(errno);
    return;
  }
  append(std::string(kMagic) +
         record(kHeader, Bytes().text(options_.profile).text(std::string("prospect ") + kVersion)));
}

bool McapWriter::append(std::string_view bytes) {
  if (!error_.empty()) return false;
  if (!file_.append(bytes)) {
    error_ = std::strerror(errno);
    return false;
  }
  at_ += bytes.size();
  data_crc_ = crc(bytes, data_crc_);
  return true;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& type,
                                      const std::string& definition) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  // One schema a channel: it is what a chunk of its own needs, and costs nothing once compressed.
  const std::uint16_t schema = id + 1;  // 0 means none
  Channel channel;
  channel.schema = record(kSchema, Bytes().u16(schema).text(type).text("ros2msg").text(definition));
  channel.channel =
      record(kChannel, Bytes().u16(id).u16(schema).text(topic).text("cdr").fields({}));
  channels_.push_back(std::move(channel));
  return id;
}

void McapWriter::metadata(const std::string& name, const Fields& fields) {
  end_chunk();
  const std::string bytes = record(kMetadata, Bytes().text(name).fields(fields));
  const std::uint64_t offset = at_;
  if (append(bytes)) metadata_.push_back({offset, bytes.size(), name});
}

bool McapWriter::message(std::uint16_t id, std::uint64_t time, std::string_view bytes) {
  if (!error_.empty() || closed_) return false;
  Channel& channel = channels_[id];
  if (!channel.told) chunk_ += channel.schema + channel.channel;
  channel.told = true;
  index_[id] += Bytes().u64(time).u64(chunk_.size()).str();
  const Bytes head = Bytes().u16(id).u32(channel.sequence++).u64(time).u64(time);
  chunk_ += static_cast<char>(kMessage);
  chunk_ += Bytes().u64(head.str().size() + bytes.size()).raw(head.str()).str();
  chunk_ += bytes;
  chunk_first_ = chunk_messages_ == 0 ? time : std::min(chunk_first_, time);
  chunk_last_ = std::max(chunk_messages_ == 0 ? 0 : chunk_last_, time);
  ++chunk_messages_;
  ++channel.messages;
  if (chunk_.size() >= options_.chunk_size) end_chunk();
  return error_.empty();
}

void McapWriter::end_chunk() {
  if (chunk_messages_ == 0) return;
  const auto [stored, compression] = compressed(chunk_, options_.compression_level);
  std::string bytes = record(kChunk, Bytes()
                                         .u64(chunk_first_)
                                         .u64(chunk_last_)
                                         .u64(chunk_.size())
                                         .u32(crc(chunk_))
                                         .text(compression)
                                         .u64(stored.size())
                                         .raw(stored));
  ChunkIndex chunk;
  chunk.first = chunk_first_;
  chunk.last = chunk_last_;
  chunk.offset = at_;
  chunk.length = bytes.size();
  chunk.compression = compression;
  chunk.compressed = stored.size();
  chunk.uncompressed = chunk_.size();
  for (const auto& [id, entries] : index_) {
    chunk.index_offsets[id] = at_ + bytes.size();
    bytes += record(kMessageIndex, Bytes().u16(id).text(entries));
  }
  chunk.index_length = bytes.size() - chunk.length;
  if (append(bytes)) {
    first_ = messages_ == 0 ? chunk_first_ : std::min(first_, chunk_first_);
    last_ = std::max(last_, chunk_last_);
    messages_ += chunk_messages_;
    chunks_.push_back(std::move(chunk));
  }
  chunk_.clear();
  index_.clear();
  chunk_messages_ = 0;
}

std::string McapWriter::summary() const {
  std::string out;
  const std::uint64_t start = at_;
  std::string groups;
  const auto group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    groups +=
        record(kSummaryOffset, Bytes().u8(opcode).u64(start + out.size()).u64(records.size()));
    out += records;
  };
  std::string schemas, channels, indices, metadata;
  std::uint64_t told = 0;
  Bytes counts;
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    const Channel& channel = channels_[id];
    if (!channel.told) continue;
    ++told;
    schemas += channel.schema;
    channels += channel.channel;
    counts.u16(id).u64(channel.messages);
  }
  for (const ChunkIndex& c : chunks_) {
    Bytes by_channel;
    for (const auto& [id, offset] : c.index_offsets) by_channel.u16(id).u64(offset);
    indices += record(kChunkIndex, Bytes()
                                       .u64(c.first)
                                       .u64(c.last)
                                       .u64(c.offset)
                                       .u64(c.length)
                                       .text(by_channel.str())
                                       .u64(c.index_length)
                                       .text(c.compression)
                                       .u64(c.compressed)
                                       .u64(c.uncompressed));
  }
  for (const Metadata& m : metadata_) {
    metadata += record(kMetadataIndex, Bytes().u64(m.offset).u64(m.length).text(m.name));
  }
  group(kSchema, schemas);
  group(kChannel, channels);
  group(kStatistics, record(kStatistics, Bytes()
                                             .u64(messages_)
                                             .u16(told)
                                             .u32(told)
                                             .u32(0)  // attachments
                                             .u32(metadata_.size())
                                             .u32(chunks_.size())
                                             .u64(first_)
                                             .u64(last_)
                                             .text(counts.str())));
  group(kChunkIndex, indices);
  group(kMetadataIndex, metadata);
  const std::uint64_t offsets_start = start + out.size();
  out += groups;
  // The checksum covers the footer up to itself.
  const std::uint64_t footer_size = 8 + 8 + 4;
  out += static_cast<char>(kFooter);
  out += Bytes().u64(footer_size).u64(start).u64(offsets_start).str();
  out += Bytes().u32(crc(out)).str();
  return out + std::string(kMagic);
}

void McapWriter::close() {
  if (closed_) return;
  end_chunk();
  closed_ = true;
  if (!append(record(kDataEnd, Bytes().u32(data_crc_)))) return;
  append(summary());
}

}  // namespace prospect
