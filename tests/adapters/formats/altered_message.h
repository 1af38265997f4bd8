// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/datasets/message_fields.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/message_definition.h"

namespace prospect::test {

/// Visits the fields of a message by their full names, and gives one of them another value: one of
/// kWays.
struct AltersField {
  static constexpr int kWays = 4;
  std::string target, prefix;
  int way = 0;
  std::vector<std::uint8_t> bytes{};  // of the altered data

  template <ros::Message T>
  void operator()(const char* name, T& value) {
    const std::string above = prefix;
    prefix += std::string(name) + ".";
    T::fields(value, *this);
    prefix = above;
  }
  template <ros::Message T>
  void operator()(const char* name, std::vector<T>& values) {
    ASSERT_FALSE(values.empty()) << name;
    (*this)(name, values.front());
  }
  template <typename T>
  void operator()(const char* name, T& value) {
    if (prefix + name == target) alter(value);
  }

  template <ros::detail::Plain T>
  void alter(T& value) {
    if (way == 0) value = static_cast<T>(value + 1);
    if (way == 1) value = value == T{} ? static_cast<T>(-1) : static_cast<T>(-value);
    if (way == 2) value = static_cast<T>(value + 100);
    if (way == 3 && std::is_floating_point_v<T>) value = std::numeric_limits<T>::quiet_NaN();
    if (way == 3 && !std::is_floating_point_v<T>) value = static_cast<T>(value + 1);
  }
  void alter(bool& value) { value = !value; }
  void alter(std::string& text) {
    if (way < 2) text += "_";
    if (way == 2) text = "32FC1; compressedDepth rvl";
    if (way == 3) text.clear();
  }
  template <typename T, std::size_t N>
  void alter(std::array<T, N>& values) {
    alter(values.front());
  }
  template <typename T>
  void alter(std::vector<T>& values) {
    if (way == 2) return values.clear();
    alter(values.front());
  }
  void alter(std::span<const std::uint8_t>& data) {
    bytes.assign(data.begin(), data.end());
    bytes[bytes.size() - 2 - static_cast<std::size_t>(way)] ^= 1U;
    data = bytes;
  }
};

/// The fields that the definition of a type names, by their full names.
inline void add_fields(const std::vector<ros::MessageDefinition>& all, const std::string& type,
                       const std::string& prefix, std::set<std::string>& names) {
  for (const ros::MessageDefinition& one : all) {
    if (one.name != type) continue;
    for (const ros::FieldDefinition& field : one.fields) {
      if (field.kind == ros::FieldDefinition::kMessage) {
        add_fields(all, field.message, prefix + field.name + ".", names);
      } else {
        names.insert(prefix + field.name);
      }
    }
  }
}

/// The table names each field of the definition once, and no other; and it is true of what becomes
/// of the messages with this field altered: `outcome`, as text, "refused..." if they are.
template <ros::Message T>
void expect_fields_of(const std::vector<T>& messages,
                      const std::function<std::string(const T& message)>& outcome) {
  std::set<std::string> defined, listed;
  add_fields(ros::definition_of<T>(), T::kType, "", defined);
  for (const FieldRule& field : fields_of(T::kType)) {
    SCOPED_TRACE(std::string(T::kType) + " " + field.name);
    EXPECT_TRUE(listed.insert(field.name).second) << "listed twice";
    int differ = 0, refused = 0, tried = 0;
    for (const T& sound : messages) {
      const std::string before = outcome(sound);
      ASSERT_FALSE(before.starts_with("refused")) << before;
      for (int way = 0; way < AltersField::kWays; ++way) {
        T message = sound;
        AltersField alters{field.name, "", way};
        T::fields(message, alters);
        if (ros::to_cdr(message) == ros::to_cdr(sound)) continue;
        const std::string after = outcome(message);
        ++tried;
        if (after.starts_with("refused")) {
          ++refused;
        } else if (after != before) {
          ++differ;
        }
      }
    }
    switch (field.use) {
      case FieldUse::kUsed:
        EXPECT_GT(differ + refused, 0);
        break;
      case FieldUse::kChecked:
        EXPECT_EQ(differ, 0);
        EXPECT_GT(refused, 0);
        break;
      case FieldUse::kRefused:
        EXPECT_EQ(refused, tried);
        break;
      case FieldUse::kNotNeeded:
        EXPECT_EQ(differ + refused, 0);
    }
    EXPECT_EQ(std::strlen(field.why) > 0, field.use == FieldUse::kNotNeeded);
  }
  EXPECT_EQ(listed, defined) << T::kType;
}

}  // namespace prospect::test
