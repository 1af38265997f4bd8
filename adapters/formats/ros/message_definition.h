// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "adapters/formats/ros/cdr.h"

namespace prospect::ros {

/// A field as the standard describes it.
struct FieldDefinition {
  /// The kinds of type_description_interfaces/msg/FieldType, of one value.
  enum Kind : int {
    kMessage = 1,
    kInt8 = 2,
    kUint8 = 3,
    kInt16 = 4,
    kUint16 = 5,
    kInt32 = 6,
    kUint32 = 7,
    kInt64 = 8,
    kUint64 = 9,
    kFloat32 = 10,
    kFloat64 = 11,
    kBool = 15,
    kByte = 16,
    kString = 17
  };
  std::string name;
  Kind kind = kUint8;
  std::string message;       ///< its type, if kMessage
  bool sequence = false;     ///< of any length
  std::size_t elements = 0;  ///< of an array; 0: none
};

/// A message and, with `name` "sensor_msgs/msg/Image", its fields in order.
struct MessageDefinition {
  std::string name;
  std::vector<FieldDefinition> fields;
};

namespace detail {

struct Describes {
  std::vector<MessageDefinition>& all;
  MessageDefinition& message;

  template <Message T>
  void one(FieldDefinition& field, const T&) {
    field.kind = FieldDefinition::kMessage;
    field.message = T::kType;
    for (const MessageDefinition& known : all) {
      if (known.name == T::kType) return;
    }
    MessageDefinition nested{T::kType, {}};
    all.push_back(nested);  // known before its own fields are
    Describes visit{all, nested};
    const T empty;
    T::fields(empty, visit);
    for (MessageDefinition& known : all) {
      if (known.name == T::kType) known = nested;
    }
  }
  template <Plain T>
  void one(FieldDefinition& field, const T&) {
    using K = FieldDefinition;
    constexpr bool is_signed = std::is_signed_v<T>;
    if constexpr (std::same_as<T, bool>) {
      field.kind = K::kBool;
    } else if constexpr (std::same_as<T, std::byte>) {
      field.kind = K::kByte;
    } else if constexpr (std::is_floating_point_v<T>) {
      field.kind = sizeof(T) == 4 ? K::kFloat32 : K::kFloat64;
    } else {
      switch (sizeof(T)) {
        case 1:
          field.kind = is_signed ? K::kInt8 : K::kUint8;
          break;
        case 2:
          field.kind = is_signed ? K::kInt16 : K::kUint16;
          break;
        case 4:
          field.kind = is_signed ? K::kInt32 : K::kUint32;
          break;
        default:
          field.kind = is_signed ? K::kInt64 : K::kUint64;
      }
    }
  }
  void one(FieldDefinition& field, const std::string&) { field.kind = FieldDefinition::kString; }
  template <typename T, std::size_t N>
  void one(FieldDefinition& field, const std::array<T, N>&) {
    field.elements = N;
    one(field, T());
  }
  template <typename T>
  void one(FieldDefinition& field, const std::vector<T>&) {
    field.sequence = true;
    one(field, T());
  }
  template <typename T>
  void one(FieldDefinition& field, const std::span<const T>&) {
    field.sequence = true;
    one(field, T());
  }
  template <typename T>
  void operator()(const char* name, const T& value) {
    FieldDefinition field;
    field.name = name;
    one(field, value);
    message.fields.push_back(field);
  }
};

}  // namespace detail

/// A message, then all messages that it is made of, by name.
template <Message T>
std::vector<MessageDefinition> definition_of() {
  std::vector<MessageDefinition> nested;
  MessageDefinition message{T::kType, {}};
  detail::Describes visit{nested, message};
  const T empty;
  T::fields(empty, visit);
  std::sort(nested.begin(), nested.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  nested.insert(nested.begin(), message);
  return nested;
}

/// The text of the definition with those of its parts, as bags of ROS 2 hold it ("ros2msg").
std::string definition_text(const std::vector<MessageDefinition>& definition);

/// The text that ROS 2 makes a type's hash of (REP 2016): its SHA-256 in hexadecimal digits behind
/// "RIHS01_".
std::string hashed_text(const std::vector<MessageDefinition>& definition);

}  // namespace prospect::ros
