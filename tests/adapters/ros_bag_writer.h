// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace prospect::test {

/// Bytes in Common Data Representation, little-endian, as ROS 2 writes messages.
class CdrWriter {
 public:
  template <typename Number>
  CdrWriter& number(Number value) {
    while ((bytes_.size() - 4) % sizeof(Number) != 0) bytes_ += '\0';
    char raw[sizeof(Number)];
    std::memcpy(raw, &value, sizeof(Number));
    bytes_.append(raw, sizeof(Number));
    return *this;
  }
  CdrWriter& text(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
    return *this;
  }
  CdrWriter& bytes(const std::string& data) {
    number(static_cast<std::uint32_t>(data.size()));
    bytes_ += data;
    return *this;
  }
  CdrWriter& doubles(const std::vector<double>& values) {
    for (const double value : values) number(value);
    return *this;
  }
  CdrWriter& header(std::int64_t ns, const std::string& frame) {
    number(static_cast<std::int32_t>(ns / 1'000'000'000));
    number(static_cast<std::uint32_t>(ns % 1'000'000'000));
    return text(frame);
  }
  CdrWriter& pose(const Eigen::Isometry3d& T) {
    const Eigen::Quaterniond q(T.linear());
    return doubles({T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(),
                    q.z(), q.w()});
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_ = std::string("\0\1\0\0", 4);
};

struct BagMessage {
  std::string topic, type;
  std::int64_t time = 0;  ///< [ns]
  std::string bytes;
};

/// Little-endian numbers and texts of MCAP.
inline std::string le(std::uint64_t value, int size) {
  std::string out;
  for (int i = 0; i < size; ++i) out += static_cast<char>(value >> (8 * i) & 255);
  return out;
}
inline std::string mcap_text(const std::string& text) { return le(text.size(), 4) + text; }
inline std::string mcap_record(int kind, const std::string& content) {
  return le(static_cast<std::uint64_t>(kind), 1) + le(content.size(), 8) + content;
}

/// An MCAP file of messages: `per_chunk` messages a chunk, 0: no chunks. `compress` makes of a
/// chunk's records what is stored, `compression` names it; `crc` gives their checksum.
template <typename Compress, typename Crc>
std::string mcap_of(const std::vector<BagMessage>& messages, int per_chunk,
                    const std::string& compression, const Compress& compress, const Crc& crc,
                    bool whole = true) {
  std::string out = std::string("\x89MCAP0\r\n", 8);
  out += mcap_record(1, mcap_text("ros2") + mcap_text("test"));
  std::vector<std::string> topics;
  std::string chunk;
  int inside = 0;
  const auto flush = [&] {
    if (inside == 0) return;
    const std::string stored = compress(chunk);
    out += mcap_record(6, le(0, 8) + le(0, 8) + le(chunk.size(), 8) + le(crc(chunk), 4) +
                              mcap_text(compression) + le(stored.size(), 8) + stored);
    chunk.clear();
    inside = 0;
  };
  for (const BagMessage& m : messages) {
    std::string records;
    std::size_t id = 0;
    while (id < topics.size() && topics[id] != m.topic) ++id;
    if (id == topics.size()) {
      topics.push_back(m.topic);
      records += mcap_record(
          3, le(id + 1, 2) + mcap_text(m.type) + mcap_text("ros2msg") + mcap_text("..."));
      records += mcap_record(
          4, le(id, 2) + le(id + 1, 2) + mcap_text(m.topic) + mcap_text("cdr") + le(0, 4));
    }
    const auto time = static_cast<std::uint64_t>(m.time);
    records += mcap_record(5, le(id, 2) + le(0, 4) + le(time, 8) + le(time, 8) + m.bytes);
    if (per_chunk == 0) {
      out += records;
      continue;
    }
    chunk += records;
    if (++inside == per_chunk) flush();
  }
  flush();
  if (whole) {
    out += mcap_record(15, le(0, 4)) + mcap_record(2, le(0, 8) + le(0, 8) + le(0, 4)) +
           std::string("\x89MCAP0\r\n", 8);
  }
  return out;
}

}  // namespace prospect::test
