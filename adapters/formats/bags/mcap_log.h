// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/bags/mcap_writer.h"

namespace prospect {

struct McapLogOptions {
  std::size_t capacity = std::size_t{64} << 20;  ///< [bytes] of messages that wait
  /// Where the queue is full: true waits for room, as a mission in lockstep may; false drops the
  /// new message and counts it, for threads that must not wait.
  bool wait = false;
  double longest_chunk = 1.0;  ///< [s] of wall time after which what has come is written
  McapWriterOptions file;
};

/// A log that any thread writes to and that makes none of them wait for the disk: a bounded queue,
/// and a thread that writes it to an MCAP file. What is killed loses what came within the last
/// `longest_chunk` or so.
///
/// Thread-safety: put(), metadata() and counts() from any thread. A lock is held for a message to
/// be moved. Nothing throws; the first write that fails is remembered in error(), and what comes
/// after it is dropped and counted.
class McapLog {
 public:
  struct Channel {
    std::string topic, type, definition;  ///< McapWriter::add_channel()
  };
  McapLog(const std::string& path, const std::vector<Channel>& channels,
          const McapLogOptions& options = {});
  ~McapLog();  ///< finish()
  McapLog(const McapLog&) = delete;
  McapLog& operator=(const McapLog&) = delete;

  /// `channel`: its place in the list. `time` [ns]. False: dropped.
  bool put(std::size_t channel, std::int64_t time, std::string bytes);
  /// In the order of messages; never dropped but for an error.
  void metadata(const std::string& name, const McapWriter::Fields& fields);
  /// Writes what waits and ends the file. Whatever comes later is dropped.
  void finish();

  struct Count {
    std::string topic;
    std::uint64_t put = 0, dropped = 0;  ///< all, and those of them that were dropped
  };
  std::vector<Count> counts() const;
  /// Empty, or why the file could not be written, in words.
  std::string error() const;

 private:
  struct Item {
    std::size_t channel = 0;
    std::uint64_t time = 0;
    std::string bytes;
    std::string metadata;  // its name; empty: a message
    McapWriter::Fields fields;
  };
  void run();

  const McapLogOptions options_;
  McapWriter writer_;  // the thread's, once that runs
  mutable std::mutex mutex_;
  std::condition_variable came_, room_;
  std::deque<Item> items_;
  std::size_t waiting_ = 0;  // [bytes]
  std::vector<Count> counts_;
  std::string error_;
  bool finished_ = false;
  std::thread thread_;
};

/// One line of what was dropped: "7 of 900 messages were dropped: 5 of /scan, 2 of /map"; "" if
/// nothing was.
std::string dropped_text(const std::vector<McapLog::Count>& counts);

}  // namespace prospect
