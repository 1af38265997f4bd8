// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "adapters/formats/ros/cdr_reader.h"
#include "adapters/formats/ros/cdr_writer.h"

namespace prospect::ros {

/// A struct of std_msgs.h and the headers beside it.
template <typename T>
concept Message = requires {
  { T::kType } -> std::convertible_to<const char*>;
};

namespace detail {

template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::same_as<T, std::byte>;

struct Writes {
  CdrWriter& w;

  template <Message T>
  void operator()(const char*, const T& value) {
    T::fields(value, *this);
  }
  template <Plain T>
  void operator()(const char*, const T& value) {
    w.number(value);
  }
  void operator()(const char*, const std::string& text) { w.text(text); }
  template <Plain T, std::size_t N>
  void operator()(const char*, const std::array<T, N>& values) {
    w.numbers(values.data(), N);
  }
  template <typename T>
  void operator()(const char* name, const std::vector<T>& values) {
    w.count(values.size());
    if constexpr (Plain<T>) {
      w.numbers(values.data(), values.size());
    } else {
      for (const T& value : values) (*this)(name, value);
    }
  }
  template <typename T>
  void operator()(const char*, const std::span<const T>& bytes) {
    static_assert(sizeof(T) == 1);
    w.bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
};

struct Reads {
  CdrReader& r;

  template <Message T>
  void operator()(const char*, T& value) {
    T::fields(value, *this);
  }
  template <Plain T>
  void operator()(const char*, T& value) {
    value = r.number<T>();
  }
  void operator()(const char*, bool& value) { value = r.number<std::uint8_t>() != 0; }
  void operator()(const char*, std::string& text) { text = r.text(); }
  template <Plain T, std::size_t N>
  void operator()(const char*, std::array<T, N>& values) {
    r.numbers(values.data(), N);
  }
  template <typename T>
  void operator()(const char* name, std::vector<T>& values) {
    const std::size_t count = r.count();
    values.clear();
    if constexpr (Plain<T>) {
      r.check_numbers(count, sizeof(T));
      values.resize(count);
      r.numbers(values.data(), count);
    } else {  // memory grows with what has been read, not with what a count claims
      for (std::size_t i = 0; i < count; ++i) (*this)(name, values.emplace_back());
    }
  }
  template <typename T>
  void operator()(const char*, std::span<const T>& bytes) {
    static_assert(sizeof(T) == 1);
    const std::string_view view = r.bytes();
    bytes = {reinterpret_cast<const T*>(view.data()), view.size()};
  }
};

}  // namespace detail

/// The message's bytes, with the head of CDR, little-endian. `extra`: bytes to reserve for what is
/// long in it.
template <Message T>
std::string to_cdr(const T& message, std::size_t extra = 0) {
  CdrWriter writer;
  writer.reserve(256 + extra);
  detail::Writes visit{writer};
  T::fields(message, visit);
  return std::move(writer).str();
}

/// The message that the bytes hold, little- or big-endian. Its views are of `cdr`. What follows it
/// is passed over. `name` stands for it in errors: InputError, one line, where the bytes end early.
/// No value is judged.
template <Message T>
T from_cdr(std::string_view cdr, const std::string& name) {
  CdrReader reader(cdr, name);
  T message;
  detail::Reads visit{reader};
  T::fields(message, visit);
  return message;
}

}  // namespace prospect::ros
