// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/ros/message_definition.h"

namespace prospect::ros {
namespace {

constexpr int kArrays = 48, kSequences = 144;  // added to the kind of what they hold

const char* name_of(FieldDefinition::Kind kind) {
  switch (kind) {
    case FieldDefinition::kInt8:
      return "int8";
    case FieldDefinition::kUint8:
      return "uint8";
    case FieldDefinition::kInt16:
      return "int16";
    case FieldDefinition::kUint16:
      return "uint16";
    case FieldDefinition::kInt32:
      return "int32";
    case FieldDefinition::kUint32:
      return "uint32";
    case FieldDefinition::kInt64:
      return "int64";
    case FieldDefinition::kUint64:
      return "uint64";
    case FieldDefinition::kFloat32:
      return "float32";
    case FieldDefinition::kFloat64:
      return "float64";
    case FieldDefinition::kBool:
      return "bool";
    case FieldDefinition::kByte:
      return "byte";
    case FieldDefinition::kString:
      return "string";
    case FieldDefinition::kMessage:
      break;
  }
  return "";
}

/// "std_msgs/Header" of "std_msgs/msg/Header", as definitions name the messages in them.
std::string short_name(const std::string& type) {
  const std::size_t at = type.find("/msg/");
  return type.substr(0, at) + type.substr(at + 4);
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

std::string hashed_type(const MessageDefinition& message) {
  std::string text = "{\"type_name\": " + quoted(message.name) + ", \"fields\": [";
  for (const FieldDefinition& field : message.fields) {
    if (text.back() != '[') text += ", ";
    const int kind = field.kind + (field.sequence ? kSequences : field.elements > 0 ? kArrays : 0);
    text += "{\"name\": " + quoted(field.name) +
            ", \"type\": {\"type_id\": " + std::to_string(kind) +
            ", \"capacity\": " + std::to_string(field.elements) +
            ", \"string_capacity\": 0, \"nested_type_name\": " + quoted(field.message) + "}}";
  }
  return text + "]}";
}

}  // namespace

std::string definition_text(const std::vector<MessageDefinition>& definition) {
  std::string text;
  for (const MessageDefinition& message : definition) {
    if (!text.empty()) {
      text += std::string(80, '=') + "\nMSG: " + short_name(message.name) + '\n';
    }
    for (const FieldDefinition& field : message.fields) {
      text +=
          field.kind == FieldDefinition::kMessage ? short_name(field.message) : name_of(field.kind);
      if (field.sequence) text += "[]";
      if (field.elements > 0) text += '[' + std::to_string(field.elements) + ']';
      text += ' ' + field.name + '\n';
    }
  }
  return text;
}

std::string hashed_text(const std::vector<MessageDefinition>& definition) {
  std::string text = "{\"type_description\": " + hashed_type(definition.front()) +
                     ", \"referenced_type_descriptions\": [";
  for (std::size_t n = 1; n < definition.size(); ++n) {
    text += (n > 1 ? ", " : "") + hashed_type(definition[n]);
  }
  return text + "]}";
}

}  // namespace prospect::ros
