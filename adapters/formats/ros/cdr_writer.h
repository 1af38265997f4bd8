// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

namespace prospect {

/// OMG's Common Data Representation, as ROS 2 writes it: little-endian, with the four bytes of the
/// head. See CdrReader.
class CdrWriter {
 public:
  template <typename Number>
  void number(Number value) {
    numbers(&value, 1);
  }
  /// `count` numbers in a row.
  template <typename Number>
  void numbers(const Number* values, std::size_t count) {
    static_assert(std::endian::native == std::endian::little);
    if (count == 0) return;
    const std::size_t body = bytes_.size() - kHead;
    bytes_.append((sizeof(Number) - body % sizeof(Number)) % sizeof(Number), '\0');
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(Number));
  }
  void count(std::size_t count) { number(static_cast<std::uint32_t>(count)); }
  void text(std::string_view text) {
    count(text.size() + 1);
    bytes_.append(text);
    bytes_.push_back('\0');
  }
  /// A sequence of bytes.
  void bytes(std::string_view data) {
    count(data.size());
    bytes_.append(data);
  }
  /// Room for so many more bytes.
  void reserve(std::size_t more) { bytes_.reserve(bytes_.size() + more); }

  const std::string& str() const& { return bytes_; }
  std::string str() && { return std::move(bytes_); }

 private:
  static constexpr std::size_t kHead = 4;
  std::string bytes_ = std::string("\0\1\0\0", kHead);
};

}  // namespace prospect
