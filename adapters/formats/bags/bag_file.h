// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace prospect {

/// A topic of a bag, and where its messages are.
struct BagTopic {
  std::string name;
  std::string type;      ///< as ROS 2 names it: "sensor_msgs/msg/Image"
  std::string encoding;  ///< of the messages: "cdr"
  struct Message {
    std::int64_t time = 0;  ///< when it was recorded [ns]
    std::size_t file = 0, chunk = 0, begin = 0, size = 0;
  };
  std::vector<Message> messages;  ///< in the order of their times; none: nothing was recorded
};

/// Whether a path is a bag by its name: a .mcap or .db3 file, compressed or not (.db3.zstd), or a
/// folder that holds such files.
bool is_bag(const std::string& path);

/// A recording of ROS 2: MCAP files (chunks plain, lz4 or zstd) or SQLite databases, one or
/// several. Files that are compressed as a whole (.zstd, .zst, .lz4) are decompressed into a file
/// without a name in the folder for temporary ones (TMPDIR); beside the same file without
/// compression they are passed over. A file that ends early, as of a recorder that was killed, is
/// read as far as it goes. Opening reads through MCAP files once. Copies share what was opened; not
/// thread-safe.
class BagFile {
 public:
  /// Throws InputError, one line: no bag, damaged, no message in it, compressed otherwise, no room
  /// to decompress it; NotBuiltIn where the library for its compression or for SQLite was absent
  /// when the program was built.
  static BagFile open(const std::string& path);

  const std::vector<BagTopic>& topics() const;
  /// Null: no such topic.
  const BagTopic* find(const std::string& name) const;
  /// The bytes of a message, as they are: they may be compressed each (bag_topics.h).
  std::string read(const BagTopic::Message& message) const;
  /// What is to be said of the files, one line each.
  const std::vector<std::string>& notes() const;
  /// The fields of a metadata record of an MCAP file, the last of that name; null: there is none.
  using Fields = std::map<std::string, std::string>;
  const Fields* metadata(const std::string& name) const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

/// A file of a bag: how it is called in messages, where it is while it is opened, and its number.
struct BagPart {
  std::string name, path;
  std::size_t number = 0;
};

// The two kinds of files. They keep the file open: its name may be removed.
class McapFile {
 public:
  McapFile(const BagPart& part, std::vector<BagTopic>& topics, std::vector<std::string>& notes);
  std::string read(const BagTopic::Message& message);
  const std::map<std::string, BagFile::Fields>& metadata() const { return metadata_; }

 private:
  std::string bytes(std::uint64_t offset, std::size_t size);
  std::string chunk(std::uint64_t offset);
  std::string path_;
  std::ifstream in_;
  std::map<std::string, BagFile::Fields> metadata_;
  std::uint64_t cached_ = 0;  ///< offset of the chunk that is at hand; 0: none
  std::string cache_;
};
/// SQL that a file brings (views, triggers, computed columns, virtual tables) is refused. What is
/// in it is listed in a child process of bounded memory and processor time; a message is no longer
/// than the file.
class BagDatabase {
 public:
  BagDatabase(const BagPart& part, std::vector<BagTopic>& topics);
  std::string read(const BagTopic::Message& message);

 private:
  struct Handle;
  std::string path_;
  std::shared_ptr<Handle> handle_;
};

/// The topic of this name, made if there is none. Throws InputError where its type differs.
BagTopic& topic_named(std::vector<BagTopic>& topics, const std::string& path,
                      const std::string& name, const std::string& type,
                      const std::string& encoding);

}  // namespace prospect
