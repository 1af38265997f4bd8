// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

#include "adapters/formats/files/input_error.h"

namespace prospect {

/// OMG's Common Data Representation, as ROS 2 writes it, little- or big-endian: numbers aligned to
/// their size, counted from behind the four bytes of the head. `name` stands for the message in
/// errors: InputError, one line. Bytes and name must outlive the reader.
class CdrReader {
 public:
  CdrReader(std::string_view bytes, const std::string& name) : name_(name) {
    if (bytes.size() < 4 || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1)) {
      throw InputError(name + ": no message in CDR; expected one of ROS 2");
    }
    swap_ = bytes[1] == 0;  // (this machine is little-endian, as all that Prospect is built for)
    bytes_ = bytes.substr(4);
  }

  template <typename Number>
  Number number() {
    Number value;
    numbers(&value, 1);
    return value;
  }
  /// `count` numbers in a row. Nothing is written if the bytes do not hold them all.
  template <typename Number>
  void numbers(Number* out, std::size_t count) {
    if (count == 0) return;
    at_ = (at_ + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number);
    check_numbers(count, sizeof(Number));
    std::memcpy(out, take(count * sizeof(Number)).data(), count * sizeof(Number));
    if (!swap_ || sizeof(Number) == 1) return;
    for (Number* one = out; one != out + count; ++one) {
      char raw[sizeof(Number)];
      std::memcpy(raw, one, sizeof(Number));
      std::reverse(std::begin(raw), std::end(raw));
      std::memcpy(one, raw, sizeof(Number));
    }
  }
  std::uint32_t count() { return number<std::uint32_t>(); }
  std::string text() {
    const auto size = count();  // with the zero at its end
    const std::string_view all = take(size);
    return std::string(all.substr(0, size > 0 ? size - 1 : 0));
  }
  /// A sequence of bytes: a view of them, not a copy.
  std::string_view bytes() { return take(count()); }

  /// Throws unless so many numbers of `size` bytes can follow: ask before memory is taken for them.
  void check_numbers(std::size_t count, std::size_t size) const {
    if (at_ > bytes_.size() || count > (bytes_.size() - at_) / size) ends_early();
  }

 private:
  std::string_view take(std::size_t size) {
    if (at_ > bytes_.size() || size > bytes_.size() - at_) ends_early();
    const std::string_view out = bytes_.substr(at_, size);
    at_ += size;
    return out;
  }
  [[noreturn]] void ends_early() const {
    throw InputError(name_ + ": the message ends early; expected all of it");
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool swap_ = false;
  const std::string& name_;
};

}  // namespace prospect
