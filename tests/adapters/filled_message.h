// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/ros/cdr.h"

namespace prospect::test {

/// Gives each field of a message another value; sequences get two or three.
struct Fills {
  int next = 1;

  template <ros::Message T>
  void operator()(const char*, T& value) {
    T::fields(value, *this);
  }
  template <ros::detail::Plain T>
  void operator()(const char*, T& value) {
    if constexpr (std::same_as<T, bool>) {
      value = true;
    } else {
      value = static_cast<T>(next++ % 100);
    }
  }
  void operator()(const char* name, std::string& text) { text = name + std::to_string(next++); }
  template <typename T, std::size_t N>
  void operator()(const char* name, std::array<T, N>& values) {
    for (T& value : values) (*this)(name, value);
  }
  template <typename T>
  void operator()(const char* name, std::vector<T>& values) {
    values.resize(2);
    for (T& value : values) (*this)(name, value);
  }
  template <typename T>
  void operator()(const char*, std::span<const T>& bytes) {
    static constexpr std::array<T, 3> kBytes = {1, 0, 127};
    bytes = kBytes;
  }
};

template <ros::Message T>
T filled() {
  T message;
  Fills fills;
  T::fields(message, fills);
  return message;
}

}  // namespace prospect::test
