// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/foxglove_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <variant>

namespace prospect::foxglove_protocol_test {
namespace {

using namespace foxglove;
using nlohmann::json;

template <typename Message>
Message parsed(const std::string& bytes, bool text = true) {
  const auto message = parse(bytes, text);
  EXPECT_TRUE(message && std::holds_alternative<Message>(*message)) << bytes;
  return message && std::holds_alternative<Message>(*message) ? std::get<Message>(*message)
                                                              : Message{};
}

TEST(FoxgloveProtocol, TheServerSaysWhatItOffers) {
  const json watching = json::parse(server_info("prospect", "7", false));
  EXPECT_EQ(watching["op"], "serverInfo");
  EXPECT_EQ(watching["sessionId"], "7");
  EXPECT_TRUE(watching["capabilities"].empty());
  const json commanding = json::parse(server_info("prospect", "7", true));
  EXPECT_EQ(commanding["capabilities"], json({"clientPublish", "services"}));
  EXPECT_EQ(commanding["supportedEncodings"], json({"cdr", "json"}));
  const json channels = json::parse(advertise({{3, "/map", "nav_msgs/msg/OccupancyGrid", "x y"}}));
  EXPECT_EQ(channels["channels"][0], json({{"id", 3},
                                           {"topic", "/map"},
                                           {"encoding", "cdr"},
                                           {"schemaName", "nav_msgs/msg/OccupancyGrid"},
                                           {"schema", "x y"},
                                           {"schemaEncoding", "ros2msg"}}));
  const json services = json::parse(advertise_services({"/stop"}));
  EXPECT_EQ(services["services"][0]["type"], "std_srvs/srv/Trigger");
  EXPECT_EQ(services["services"][0]["response"]["encoding"], "cdr");
  EXPECT_EQ(json::parse(status(Level::kError, "no"))["level"], 2);
  EXPECT_EQ(json::parse(service_failure(1, 2, "no"))["callId"], 2);
}

TEST(FoxgloveProtocol, BinaryMessagesAreAsThePageOfTheProtocolSays) {
  EXPECT_EQ(message_data(0x04030201, 0x0807060504030201, "abc"),
            std::string("\x01\x01\x02\x03\x04\x01\x02\x03\x04\x05\x06\x07\x08"
                        "abc"));
  // Head of CDR, success, the padding before a length, the text with its zero.
  EXPECT_EQ(service_response(1, 2, true, "ok"),
            std::string("\x03\1\0\0\0\2\0\0\0\3\0\0\0cdr\0\1\0\0\1\0\0\0\3\0\0\0ok\0", 31));
}

TEST(FoxgloveProtocol, WhatAClientSaysIsRead) {
  const auto subscribe = parsed<Subscribe>(
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":5},{"id":2,"channelId":6}]})");
  ASSERT_EQ(subscribe.subscriptions.size(), 2U);
  EXPECT_EQ(subscribe.subscriptions[1].id, 2U);
  EXPECT_EQ(subscribe.subscriptions[1].channel, 6U);
  EXPECT_EQ(parsed<Unsubscribe>(R"({"op":"unsubscribe","subscriptionIds":[4]})").ids.at(0), 4U);
  const auto channel = parsed<ClientAdvertise>(
      R"({"op":"advertise","channels":[{"id":9,"topic":"/goal","encoding":"cdr","schemaName":"p"}]})");
  EXPECT_EQ(channel.channels.at(0).topic, "/goal");
  EXPECT_EQ(parsed<ClientUnadvertise>(R"({"op":"unadvertise","channelIds":[9]})").ids.at(0), 9U);
  EXPECT_EQ(parsed<Other>(R"({"op":"getParameters"})").op, "getParameters");
  const auto data = parsed<ClientData>(std::string("\1\x09\0\0\0xyz", 8), false);
  EXPECT_EQ(data.channel, 9U);
  EXPECT_EQ(data.bytes, "xyz");
  const auto call =
      parsed<ServiceCall>(std::string("\2\1\0\0\0\7\0\0\0\3\0\0\0cdr\0\1\0\0", 20), false);
  EXPECT_EQ(call.service, 1U);
  EXPECT_EQ(call.call, 7U);
}

TEST(FoxgloveProtocol, WhatIsNoMessageIsNone) {
  for (const char* bad :
       {"", "[]", "1", "{}", "subscribe", R"({"op":7})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":7})", R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":5}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":5}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":5}]})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})", "\xff"}) {
    EXPECT_FALSE(parse(bad, true)) << bad;
  }
  for (const std::string& bad : {std::string(), std::string("\1"), std::string("\1\0\0\0", 4),
                                 std::string("\7\0\0\0\0", 5), std::string("\2\1\0\0\0\7\0\0\0", 9),
                                 std::string("\2\1\0\0\0\7\0\0\0\xff\xff\xff\xff", 13)}) {
    EXPECT_FALSE(parse(bad, false)) << testing::PrintToString(bad);
  }
}

}  // namespace
}  // namespace prospect::foxglove_protocol_test
