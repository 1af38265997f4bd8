// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/bags/mcap_log.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace prospect {
namespace {

constexpr std::size_t kItemSize = 128;  // [bytes] of an item besides its message, about

}  // namespace

McapLog::McapLog(const std::string& path, const std::vector<Channel>& channels,
                 const McapLogOptions& options)
    : options_(options), writer_(path, options.file) {
  for (const Channel& channel : channels) {
    writer_.add_channel(channel.topic, channel.type, channel.definition);
    counts_.push_back({channel.topic, 0, 0});
  }
  error_ = writer_.error();
  thread_ = std::thread([this] { run(); });
}

McapLog::~McapLog() { finish(); }

bool McapLog::put(std::size_t channel, std::int64_t time, std::string bytes) {
  std::unique_lock lock(mutex_);
  Count& count = counts_[channel];
  ++count.put;
  const std::size_t size = bytes.size() + kItemSize;
  const auto fits = [&] {
    return finished_ || !error_.empty() || items_.empty() || waiting_ + size <= options_.capacity;
  };
  if (options_.wait) room_.wait(lock, fits);
  if (finished_ || !error_.empty() || !fits()) {
    ++count.dropped;
    return false;
  }
  waiting_ += size;
  Item item;
  item.channel = channel;
  item.time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, time));
  item.bytes = std::move(bytes);
  items_.push_back(std::move(item));
  lock.unlock();
  came_.notify_one();
  return true;
}

void McapLog::metadata(const std::string& name, const McapWriter::Fields& fields) {
  {
    const std::lock_guard lock(mutex_);
    if (finished_) return;
    Item item;
    item.metadata = name;
    item.fields = fields;
    items_.push_back(std::move(item));
  }
  came_.notify_one();
}

void McapLog::run() {
  using Clock = std::chrono::steady_clock;
  const std::chrono::duration<double> longest(options_.longest_chunk);
  Clock::time_point written = Clock::now();
  for (bool last = false; !last;) {
    std::deque<Item> items;
    {
      std::unique_lock lock(mutex_);
      came_.wait_for(lock, longest, [this] { return finished_ || !items_.empty(); });
      items.swap(items_);
      last = finished_;
    }
    for (Item& item : items) {
      if (!item.metadata.empty()) {
        writer_.metadata(item.metadata, item.fields);
        continue;
      }
      const bool kept =
          writer_.message(static_cast<std::uint16_t>(item.channel), item.time, item.bytes);
      {
        const std::lock_guard lock(mutex_);
        waiting_ -= item.bytes.size() + kItemSize;
        if (!kept) ++counts_[item.channel].dropped;
      }
      room_.notify_all();
    }
    if (last) {
      writer_.close();
    } else if (const Clock::time_point now = Clock::now(); now - written >= longest) {
      writer_.end_chunk();
      written = now;
    }
    if (!writer_.error().empty()) {
      const std::lock_guard lock(mutex_);
      error_ = writer_.error();
      room_.notify_all();
    }
  }
}

void McapLog::finish() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  came_.notify_one();
  room_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::vector<McapLog::Count> McapLog::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::string McapLog::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::string dropped_text(const std::vector<McapLog::Count>& counts) {
  std::uint64_t all = 0, dropped = 0;
  std::string of;
  for (const McapLog::Count& count : counts) {
    all += count.put;
    dropped += count.dropped;
    if (count.dropped == 0) continue;
    of += (of.empty() ? "" : ", ") + std::to_string(count.dropped) + " of " + count.topic;
  }
  if (dropped == 0) return "";
  return std::to_string(dropped) + " of " + std::to_string(all) + " messages were dropped: " + of;
}

}  // namespace prospect
