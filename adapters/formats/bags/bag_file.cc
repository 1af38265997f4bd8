// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/bag_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "adapters/formats/bags/decompression.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/temporary_file.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;

/// Endings of files that are compressed as a whole; those without a compression are not read.
struct PackedEnding {
  const char* ending;
  Compression compression;
};
constexpr PackedEnding kPackedEndings[] = {
    {".zstd", Compression::kZstd}, {".zst", Compression::kZstd}, {".lz4", Compression::kLz4},
    {".gz", Compression::kNone},   {".xz", Compression::kNone},  {".bz2", Compression::kNone}};

/// Null: not compressed as a whole, by its name.
const PackedEnding* packed_ending(const fs::path& name) {
  for (const PackedEnding& packed : kPackedEndings) {
    if (name.extension() == packed.ending) return &packed;
  }
  return nullptr;
}

/// Without the ending of its compression.
fs::path plain_name(const fs::path& name) {
  return packed_ending(name) != nullptr ? fs::path(name).replace_extension() : name;
}

bool is_bag_file(const fs::path& name) {
  const fs::path ending = plain_name(name).extension();
  return ending == ".mcap" || ending == ".db3";
}

std::vector<std::string> bag_files(const std::string& path) {
  std::error_code error;
  std::vector<std::string> files;
  if (fs::is_directory(path, error)) {
    for (const auto& entry : fs::directory_iterator(path, error)) {
      const fs::path& file = entry.path();
      const bool twice = packed_ending(file) != nullptr && fs::exists(plain_name(file), error);
      if (is_bag_file(file) && file.filename().string()[0] != '.' && !twice) {
        files.push_back(file.string());
      }
    }
    std::sort(files.begin(), files.end());
  } else if (is_bag_file(path) && fs::is_regular_file(path, error)) {
    files.push_back(path);
  }
  return files;
}

/// The file `path` of a bag, decompressed into `to`.
void unpack(const std::string& path, const PackedEnding& packed, TemporaryFile& to) {
  if (packed.compression == Compression::kNone) {
    throw InputError(path + ": compressed as a whole by " + (packed.ending + 1) +
                     "; expected .zstd, .lz4 or it decompressed");
  }
  std::ifstream in(path, std::ios::binary);
  std::string buffer(std::size_t{1} << 17, '\0');
  decompress(
      packed.compression,
      [&] {
        in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        return std::string_view(buffer).substr(0, static_cast<std::size_t>(in.gcount()));
      },
      [&](std::string_view piece) { to.append(piece); }, path);
}

}  // namespace

struct BagFile::Impl {
  struct File {
    std::optional<McapFile> mcap;
    std::optional<BagDatabase> database;
  };
  std::vector<File> files;
  std::vector<BagTopic> topics;
  std::vector<std::string> notes;
};

bool is_bag(const std::string& path) { return !bag_files(path).empty(); }

BagFile BagFile::open(const std::string& path) {
  BagFile bag;
  bag.impl_ = std::make_shared<Impl>();
  Impl& impl = *bag.impl_;
  const std::vector<std::string> files = bag_files(path);
  if (files.empty())
    throw InputError(path +
                     ": no bag; expected a .mcap or .db3 file, or one compressed (.zstd, .lz4)");
  for (const std::string& file : files) {
    Impl::File opened;
    BagPart part{file, file, impl.files.size()};
    std::optional<TemporaryFile> unpacked;
    if (const PackedEnding* packed = packed_ending(file)) {
      unpack(file, *packed, unpacked.emplace("prospect_bag", "to decompress a bag"));
      part.path = unpacked->path();
    }
    if (plain_name(file).extension() == ".mcap") {
      opened.mcap.emplace(part, impl.topics, impl.notes);
    } else {
      opened.database.emplace(part, impl.topics);
    }
    impl.files.push_back(std::move(opened));
  }
  std::size_t messages = 0;
  for (BagTopic& topic : impl.topics) {
    std::stable_sort(
        topic.messages.begin(), topic.messages.end(),
        [](const BagTopic::Message& a, const BagTopic::Message& b) { return a.time < b.time; });
    messages += topic.messages.size();
  }
  if (messages == 0) throw InputError(path + ": holds no message; expected a recording");
  return bag;
}

const std::vector<BagTopic>& BagFile::topics() const { return impl_->topics; }
const std::vector<std::string>& BagFile::notes() const { return impl_->notes; }

const BagTopic* BagFile::find(const std::string& name) const {
  for (const BagTopic& topic : impl_->topics) {
    if (topic.name == name) return &topic;
  }
  return nullptr;
}

const BagFile::Fields* BagFile::metadata(const std::string& name) const {
  for (auto file = impl_->files.rbegin(); file != impl_->files.rend(); ++file) {
    if (!file->mcap) continue;
    const auto found = file->mcap->metadata().find(name);
    if (found != file->mcap->metadata().end()) return &found->second;
  }
  return nullptr;
}

std::string BagFile::read(const BagTopic::Message& message) const {
  Impl::File& file = impl_->files[message.file];
  return file.mcap ? file.mcap->read(message) : file.database->read(message);
}

BagTopic& topic_named(std::vector<BagTopic>& topics, const std::string& path,
                      const std::string& name, const std::string& type,
                      const std::string& encoding) {
  for (BagTopic& topic : topics) {
    if (topic.name != name) continue;
    if (topic.type != type) {
      throw InputError(path + ": topic " + name + " has the types " + topic.type + " and " + type +
                       "; expected one");
    }
    return topic;
  }
  topics.push_back({name, type, encoding, {}});
  return topics.back();
}

}  // namespace prospect
