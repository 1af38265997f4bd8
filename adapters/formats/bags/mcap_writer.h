// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/row_file.h"

namespace prospect {

struct McapWriterOptions {
  std::string profile = "ros2";
  std::size_t chunk_size = std::size_t{1} << 20;  ///< [bytes] of records after which a chunk ends
  int compression_level = 1;  ///< of zstd; where that was absent at build time, chunks are plain
};

/// A file of the format MCAP (mcap.dev/spec): header, chunks of messages with an index each,
/// metadata, and at close() the summary: schemas, channels, statistics, indices, offsets, checksums
/// (CRC-32) of chunks, data and summary.
///
/// Each chunk goes to the operating system in one write, whole; what does not fit (disk full) is
/// taken back. So a file whose writer was killed is whole up to the last chunk that was written,
/// and a reader that goes through it from the start finds all of them. A file without close() has
/// no summary and no end, by which readers see that it is not whole.
///
/// The first write that fails is remembered in error(); nothing is written after it, and message()
/// returns false. Nothing throws. Not thread-safe.
class McapWriter {
 public:
  explicit McapWriter(const std::string& path, McapWriterOptions options = {});

  using Fields = std::map<std::string, std::string>;
  /// A channel of messages in CDR. Its type is described by the text of a ROS 2 .msg file, with the
  /// definitions of the types that it is made of. At most 65535 channels.
  std::uint16_t add_channel(const std::string& topic, const std::string& type,
                            const std::string& definition);
  /// At once, before the messages that follow.
  void metadata(const std::string& name, const Fields& fields);
  /// Times since the epoch of the log [ns]. `channel` is one of add_channel(). False: not kept.
  bool message(std::uint16_t channel, std::uint64_t time, std::string_view bytes);
  /// Ends the chunk that is being filled, if it holds anything.
  void end_chunk();
  /// Ends the file. Nothing may follow.
  void close();

  bool is_open() const { return file_.is_open(); }
  std::uint64_t bytes_written() const { return at_; }
  std::uint64_t messages() const { return messages_; }
  /// Empty, or what went wrong first, in words.
  const std::string& error() const { return error_; }

 private:
  struct Channel {
    std::string schema, channel;  // records
    bool told = false;            // in a chunk
    std::uint32_t sequence = 0;
    std::uint64_t messages = 0;
  };
  struct ChunkIndex {
    std::uint64_t first = 0, last = 0, offset = 0, length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
    std::uint64_t index_length = 0, compressed = 0, uncompressed = 0;
    std::string compression;
  };
  struct Metadata {
    std::uint64_t offset = 0, length = 0;
    std::string name;
  };

  bool append(std::string_view bytes);
  std::string summary() const;

  RowFile file_;
  McapWriterOptions options_;
  std::string error_;
  std::uint64_t at_ = 0;        // bytes of the file
  std::uint32_t data_crc_ = 0;  // of all of them
  std::vector<Channel> channels_;
  std::vector<ChunkIndex> chunks_;
  std::vector<Metadata> metadata_;
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0;
  bool closed_ = false;
  // The chunk that is being filled.
  std::string chunk_;
  std::map<std::uint16_t, std::string> index_;  // time and offset of each message
  std::uint64_t chunk_messages_ = 0, chunk_first_ = 0, chunk_last_ = 0;
};

}  // namespace prospect
