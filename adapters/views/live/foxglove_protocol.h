// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace prospect::foxglove {

// Messages of Foxglove's WebSocket protocol, version 1: text in JSON, and binary ones, which begin
// with a byte that says what they are; numbers are little-endian. Pure functions.

/// Names of the protocol: that of Foxglove, and that of Lichtblick and older programs. They differ
/// in nothing else.
inline constexpr std::array<std::string_view, 2> kProtocols = {"foxglove.sdk.v1",
                                                               "foxglove.websocket.v1"};

// ---- From the server
// -----------------------------------------------------------------------------

/// may_command: services can be called and messages published.
std::string server_info(const std::string& name, const std::string& session, bool may_command);

struct Channel {
  std::uint32_t id = 0;
  std::string topic, type, definition;  ///< of messages in CDR, as "ros2msg"
};
std::string advertise(const std::vector<Channel>& channels);

/// Services of the type std_srvs/srv/Trigger; each has its place in the list as id.
std::string advertise_services(const std::vector<std::string>& names);

/// A message of a channel, for one subscription; time [ns] since 1970.
std::string message_data(std::uint32_t subscription, std::int64_t time, std::string_view bytes);

/// The answer of a Trigger.
std::string service_response(std::uint32_t service, std::uint32_t call, bool success,
                             const std::string& message);
std::string service_failure(std::uint32_t service, std::uint32_t call, const std::string& message);

enum class Level { kInfo = 0, kWarning = 1, kError = 2 };
std::string status(Level level, const std::string& message);

// ---- From a client
// -------------------------------------------------------------------------------

struct Subscription {
  std::uint32_t id = 0, channel = 0;
};
struct Subscribe {
  std::vector<Subscription> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
/// A channel that the client publishes on.
struct ClientChannel {
  std::uint32_t id = 0;
  std::string topic, encoding, type;
};
struct ClientAdvertise {
  std::vector<ClientChannel> channels;
};
struct ClientUnadvertise {
  std::vector<std::uint32_t> ids;
};
struct ClientData {
  std::uint32_t channel = 0;
  std::string bytes;
};
struct ServiceCall {
  std::uint32_t service = 0, call = 0;
};
/// Something else of the protocol, that this server has not offered: nothing is done.
struct Other {
  std::string op;
};
using ClientMessage = std::variant<Subscribe, Unsubscribe, ClientAdvertise, ClientUnadvertise,
                                   ClientData, ServiceCall, Other>;
/// None: it is no message of the protocol.
std::optional<ClientMessage> parse(std::string_view bytes, bool text);

}  // namespace prospect::foxglove
