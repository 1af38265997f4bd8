// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/foxglove_protocol.h"

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/std_srvs.h"

namespace prospect::foxglove {
namespace {

using Json = nlohmann::ordered_json;

// The first byte of a binary message.
constexpr char kMessageData = 1, kServiceResponse = 3;           // of the server
constexpr char kClientMessageData = 1, kServiceCallRequest = 2;  // of a client

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <typename Number>
void add(std::string& bytes, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(number) >> (8 * i));
  }
}

/// Takes four bytes off the front; none: there are fewer.
std::optional<std::uint32_t> take(std::string_view& bytes) {
  if (bytes.size() < 4) return std::nullopt;
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  bytes.remove_prefix(4);
  return number;
}

std::optional<std::uint32_t> number_of(const nlohmann::json& json) {
  if (!json.is_number_unsigned()) return std::nullopt;
  const auto number = json.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}
std::optional<std::uint32_t> number_in(const nlohmann::json& object, const char* key) {
  const auto at = object.is_object() ? object.find(key) : object.end();
  return at == object.end() ? std::nullopt : number_of(*at);
}
std::string text_in(const nlohmann::json& object, const char* key) {
  const auto at = object.is_object() ? object.find(key) : object.end();
  return at == object.end() || !at->is_string() ? "" : at->get<std::string>();
}

/// Each entry of the list as `read` gives it; none: there is no such list, or a wrong entry in it.
template <typename Value, typename Read>
std::optional<std::vector<Value>> list_in(const nlohmann::json& object, const char* key,
                                          const Read& read) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_array()) return std::nullopt;
  std::vector<Value> values;
  for (const nlohmann::json& entry : *at) {
    std::optional<Value> value = read(entry);
    if (!value) return std::nullopt;
    values.push_back(std::move(*value));
  }
  return values;
}

std::optional<ClientMessage> parse_text(std::string_view bytes) {
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  const std::string op = text_in(json, "op");
  if (op == "subscribe") {
    auto list = list_in<Subscription>(json, "subscriptions", [](const nlohmann::json& entry) {
      const auto id = number_in(entry, "id"), channel = number_in(entry, "channelId");
      return id && channel ? std::optional(Subscription{*id, *channel}) : std::nullopt;
    });
    if (!list) return std::nullopt;
    return Subscribe{std::move(*list)};
  }
  if (op == "advertise") {
    auto list = list_in<ClientChannel>(json, "channels", [](const nlohmann::json& entry) {
      const auto id = number_in(entry, "id");
      return id ? std::optional(ClientChannel{*id, text_in(entry, "topic"),
                                              text_in(entry, "encoding"),
                                              text_in(entry, "schemaName")})
                : std::nullopt;
    });
    if (!list) return std::nullopt;
    return ClientAdvertise{std::move(*list)};
  }
  if (op == "unsubscribe" || op == "unadvertise") {
    auto list = list_in<std::uint32_t>(json, op == "unsubscribe" ? "subscriptionIds" : "channelIds",
                                       number_of);
    if (!list) return std::nullopt;
    if (op == "unsubscribe") return Unsubscribe{std::move(*list)};
    return ClientUnadvertise{std::move(*list)};
  }
  if (op.empty()) return std::nullopt;
  return Other{op};
}

std::optional<ClientMessage> parse_binary(std::string_view bytes) {
  if (bytes.empty()) return std::nullopt;
  const char op = bytes.front();
  bytes.remove_prefix(1);
  const std::optional<std::uint32_t> first = take(bytes);
  if (!first) return std::nullopt;
  if (op == kClientMessageData) return ClientData{*first, std::string(bytes)};
  if (op != kServiceCallRequest) return std::nullopt;
  // The encoding and the request follow; a Trigger's holds nothing.
  const std::optional<std::uint32_t> call = take(bytes), encoding = take(bytes);
  if (!call || !encoding || *encoding > bytes.size()) return std::nullopt;
  return ServiceCall{*first, *call};
}

}  // namespace

std::string server_info(const std::string& name, const std::string& session, bool may_command) {
  Json capabilities = Json::array();
  if (may_command) capabilities = {"clientPublish", "services"};
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", std::move(capabilities)},
                  {"supportedEncodings", {"cdr", "json"}},
                  {"metadata", {{"ROS_DISTRO", "jazzy"}}},
                  {"sessionId", session}});
}

std::string advertise(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schema", channel.definition},
                    {"schemaEncoding", "ros2msg"}});
  }
  return text_of({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string advertise_services(const std::vector<std::string>& names) {
  const std::string response = "bool success\nstring message\n";
  Json list = Json::array();
  for (std::size_t id = 0; id < names.size(); ++id) {
    // The schemas twice, as older programs read the last two alone.
    list.push_back({{"id", id},
                    {"name", names[id]},
                    {"type", "std_srvs/srv/Trigger"},
                    {"request",
                     {{"encoding", "cdr"},
                      {"schemaName", "std_srvs/srv/Trigger_Request"},
                      {"schemaEncoding", "ros2msg"},
                      {"schema", ""}}},
                    {"response",
                     {{"encoding", "cdr"},
                      {"schemaName", "std_srvs/srv/Trigger_Response"},
                      {"schemaEncoding", "ros2msg"},
                      {"schema", response}}},
                    {"requestSchema", ""},
                    {"responseSchema", response}});
  }
  return text_of({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string message_data(std::uint32_t subscription, std::int64_t time, std::string_view bytes) {
  std::string message(1, kMessageData);
  message.reserve(13 + bytes.size());
  add(message, subscription);
  add(message, time);
  message += bytes;
  return message;
}

std::string service_response(std::uint32_t service, std::uint32_t call, bool success,
                             const std::string& message) {
  std::string bytes(1, kServiceResponse);
  add(bytes, service);
  add(bytes, call);
  add(bytes, std::uint32_t{3});
  return bytes + "cdr" + ros::to_cdr(ros::TriggerResponse{success, message});
}

std::string service_failure(std::uint32_t service, std::uint32_t call, const std::string& message) {
  return text_of({{"op", "serviceCallFailure"},
                  {"serviceId", service},
                  {"callId", call},
                  {"message", message}});
}

std::string status(Level level, const std::string& message) {
  return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::optional<ClientMessage> parse(std::string_view bytes, bool text) {
  return text ? parse_text(bytes) : parse_binary(bytes);
}

}  // namespace prospect::foxglove
