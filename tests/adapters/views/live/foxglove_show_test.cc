// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/foxglove_show.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/missions/config/configuration.h"
#include "tests/adapters/synthetic_run.h"

namespace prospect::foxglove_show_test {
namespace {

using nlohmann::json;

class FoxgloveShowTest : public ::testing::Test {
 protected:
  static MissionMessageOptions options() {
    MissionMessageOptions options;
    options.robot = configuration_from_text("", "test").robot;
    return options;
  }
  static LiveFeed::News step(int number) {
    static const RunRecord run = synthetic_run(100);
    LiveFeed::News news;
    news.steps = {std::make_shared<StepRecord>(run.steps[static_cast<std::size_t>(number)])};
    return news;
  }
  /// What a viewer is told by now: texts, and binary messages by subscription.
  struct Told {
    std::vector<json> texts;
    std::map<std::uint32_t, std::vector<std::string>> data;
    std::vector<std::string> responses;
  };
  static Told told(Viewer& viewer) {
    Told told;
    while (const std::optional<LiveMessage> message = viewer.next()) {
      const std::string& bytes = *message->bytes;
      if (!message->binary) {
        told.texts.push_back(json::parse(bytes));
      } else if (bytes[0] == 1) {
        told.data[static_cast<std::uint8_t>(bytes[1])].push_back(bytes.substr(13));
      } else {
        told.responses.push_back(bytes);
      }
    }
    return told;
  }
  static std::map<std::string, std::uint32_t> channels_of(const Told& told) {
    std::map<std::string, std::uint32_t> channels;
    for (const json& text : told.texts) {
      if (text["op"] != "advertise") continue;
      for (const json& channel : text["channels"]) channels[channel["topic"]] = channel["id"];
    }
    return channels;
  }
  static std::string subscribe(std::uint32_t id, std::uint32_t channel) {
    return json({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}})
        .dump();
  }

  DriveRequests requests_;
  DriveCommands commands_{requests_};
  FoxgloveShow show_{options(), commands_};
};

TEST_F(FoxgloveShowTest, WhoComesLateGetsTheNewestOfEachTopicAndTheWholeMap) {
  for (int k = 0; k < 50; ++k) show_.add(step(k));
  const auto viewer = show_.viewer(false);
  const auto channels = channels_of(told(*viewer));
  for (const char* topic : {"/tf_static", "/odometry", "/map", "/plan", "/plan/step", "/rosout"}) {
    EXPECT_TRUE(channels.contains(topic)) << topic;
  }
  for (const char* topic : {"/cmd_vel", "/map_updates", "/scan", "/camera/left/image_rect"}) {
    EXPECT_FALSE(channels.contains(topic)) << topic << ": nobody would tell it";
  }
  ASSERT_TRUE(viewer->message(subscribe(1, channels.at("/map")), true));
  ASSERT_TRUE(viewer->message(subscribe(2, channels.at("/tf_static")), true));
  Told first = told(*viewer);
  ASSERT_EQ(first.data[1].size(), 1U);
  ASSERT_EQ(first.data[2].size(), 1U);
  const auto map = ros::from_cdr<ros::OccupancyGrid>(first.data[1][0], "map");
  std::size_t known = 0;
  for (const std::int8_t cell : map.data) known += cell >= 0;
  std::set<std::pair<int, int>> cells;
  for (int k = 0; k < 50; ++k) {
    const LiveFeed::News news = step(k);
    for (const auto& [cell, state] : news.steps[0]->map_changes) cells.emplace(cell.i, cell.j);
  }
  EXPECT_EQ(known, cells.size());
  show_.add(step(50));
  EXPECT_EQ(told(*viewer).data[1].size(), 1U);
}

TEST_F(FoxgloveShowTest, ASlowViewerHasBoundedQueuesAndTheNewestMap) {
  const auto viewer = show_.viewer(false);
  const auto channels = channels_of(told(*viewer));
  viewer->message(subscribe(1, channels.at("/map")), true);
  viewer->message(subscribe(2, channels.at("/plan/step")), true);
  std::size_t maps = 0;
  for (int k = 0; k < 100; ++k) {
    const LiveFeed::News news = step(k);
    maps += !news.steps[0]->map_changes.empty();
    show_.add(news);
  }
  ASSERT_GT(maps, 50U);
  Told late = told(*viewer);
  EXPECT_EQ(late.data[1].size(), 1U);
  EXPECT_EQ(late.data[2].size(), FoxgloveShow::kWaiting);
  EXPECT_EQ(viewer->dropped(), maps - 1 + 100U - FoxgloveShow::kWaiting);
}

TEST_F(FoxgloveShowTest, ServicesCommandTheRobotOfOneWhoMay) {
  const auto viewer = show_.viewer(true);
  std::map<std::string, std::uint32_t> services;
  for (const json& text : told(*viewer).texts) {
    if (text["op"] != "advertiseServices") continue;
    for (const json& service : text["services"]) services[service["name"]] = service["id"];
  }
  const auto call = [&](const std::string& name) {
    std::string bytes("\2\0\0\0\0\7\0\0\0\3\0\0\0cdr", 16);
    bytes[1] = static_cast<char>(services.at("/prospect/" + name));
    EXPECT_TRUE(viewer->message(bytes, false));
    const Told answer = told(*viewer);
    EXPECT_EQ(answer.responses.size(), 1U);
    return !answer.responses.empty() && answer.responses[0][20] == 1;
  };
  EXPECT_TRUE(call("hold"));
  EXPECT_FALSE(requests_.told_to_drive());
  EXPECT_TRUE(call("resume"));
  EXPECT_TRUE(requests_.told_to_drive());
  EXPECT_TRUE(call("stop"));
  EXPECT_TRUE(requests_.take_emergency_stop());
  requests_.set_stopped(true);
  EXPECT_FALSE(call("resume")) << "before it is acknowledged";
  EXPECT_TRUE(call("acknowledge"));
  EXPECT_TRUE(requests_.take_acknowledgement());
}

TEST_F(FoxgloveShowTest, APublishedPoseIsAPlaceToGoTo) {
  const auto viewer = show_.viewer(true);
  told(*viewer);
  const std::string advertise =
      R"({"op":"advertise","channels":[{"id":3,"topic":"/goal","encoding":"cdr","schemaName":"geometry_msgs/msg/PoseStamped"},)"
      R"({"id":4,"topic":"/goal","encoding":"json","schemaName":"geometry_msgs/PoseStamped"}]})";
  ASSERT_TRUE(viewer->message(advertise, true));
  ros::PoseStamped pose;
  pose.pose.position = {1.5, -2.0, 0.0};
  ASSERT_TRUE(viewer->message(std::string("\1\3\0\0\0", 5) + ros::to_cdr(pose), false));
  auto place = requests_.take_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->position, Eigen::Vector2d(1.5, -2.0));
  EXPECT_EQ(place->yaw, 0.0);
  ASSERT_TRUE(viewer->message(
      std::string("\1\4\0\0\0", 5) + R"({"pose":{"position":{"x":3,"y":4.5,"z":0}}})", false));
  place = requests_.take_place();
  ASSERT_TRUE(place);
  EXPECT_EQ(place->position, Eigen::Vector2d(3.0, 4.5));
  EXPECT_FALSE(place->yaw) << "it says none";
  // Heading to the left.
  pose.pose.orientation = {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)};
  const auto in_json = [](const std::string& z, const std::string& w) {
    return std::string("\1\4\0\0\0", 5) + R"({"pose":{"position":{"x":3,"y":4.5},"orientation":)" +
           R"({"x":0,"y":0,"z":)" + z + ",\"w\":" + w + "}}}";
  };
  for (const std::string& message :
       {std::string("\1\3\0\0\0", 5) + ros::to_cdr(pose), in_json("0.70710678", "0.70710678")}) {
    ASSERT_TRUE(viewer->message(message, false));
    place = requests_.take_place();
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->yaw.value(), M_PI_2, 1e-6);
  }
  EXPECT_TRUE(told(*viewer).texts.empty());
  pose.pose.orientation = {0.0, -std::sqrt(0.5), 0.0, std::sqrt(0.5)};  // up
  for (const std::string& message : {std::string("\1\3\0\0\0", 5) + ros::to_cdr(pose),
                                     in_json("1", "1"), in_json("0", "null")}) {
    ASSERT_TRUE(viewer->message(message, false));
    EXPECT_FALSE(requests_.take_place());
    EXPECT_EQ(told(*viewer).texts.size(), 1U);
  }
  pose.pose.orientation = {};
  EXPECT_TRUE(told(*viewer).texts.empty());
  // In another frame it is another place.
  pose.header.frame_id = "map";
  ASSERT_TRUE(viewer->message(std::string("\1\3\0\0\0", 5) + ros::to_cdr(pose), false));
  EXPECT_TRUE(requests_.take_place());
  EXPECT_TRUE(told(*viewer).texts.empty());
  for (const std::string frame : {"base_link", "odom", "/map", "camera"}) {
    pose.header.frame_id = frame;
    const std::string json =
        R"({"header":{"frame_id":")" + frame + R"("},"pose":{"position":{"x":3,"y":4.5}}})";
    for (const std::string& message :
         {std::string("\1\3\0\0\0", 5) + ros::to_cdr(pose), std::string("\1\4\0\0\0", 5) + json}) {
      EXPECT_TRUE(viewer->message(message, false));
      const auto texts = told(*viewer).texts;
      ASSERT_EQ(texts.size(), 1U) << frame;
      EXPECT_THAT(texts[0]["message"].get<std::string>(),
                  testing::HasSubstr("expected one in map"));
      EXPECT_FALSE(requests_.take_place()) << frame;
    }
  }
  for (const std::string& bad : {std::string("\1\3\0\0\0xyz", 8), std::string("\1\4\0\0\0{}", 7),
                                 std::string("\1\7\0\0\0xyz", 8)}) {
    EXPECT_TRUE(viewer->message(bad, false));
    EXPECT_EQ(told(*viewer).texts.size(), 1U) << "it is told what is wrong";
  }
  EXPECT_FALSE(requests_.take_place());
}

TEST_F(FoxgloveShowTest, WhoOnlyWatchesCommandsNothing) {
  const auto viewer = show_.viewer(false);
  for (const json& text : told(*viewer).texts) EXPECT_NE(text["op"], "advertiseServices");
  for (char service = 0; service < 4; ++service) {
    std::string bytes("\2\0\0\0\0\7\0\0\0\3\0\0\0cdr", 16);
    bytes[1] = service;
    EXPECT_TRUE(viewer->message(bytes, false));
    EXPECT_EQ(told(*viewer).texts.at(0)["op"], "serviceCallFailure");
  }
  viewer->message(
      R"({"op":"advertise","channels":[{"id":3,"topic":"/goal","encoding":"json","schemaName":"geometry_msgs/PoseStamped"}]})",
      true);
  viewer->message(std::string("\1\3\0\0\0", 5) + R"({"pose":{"position":{"x":3,"y":4}}})", false);
  EXPECT_EQ(told(*viewer).texts.size(), 2U);
  EXPECT_TRUE(requests_.told_to_drive());
  EXPECT_FALSE(requests_.take_emergency_stop());
  EXPECT_FALSE(requests_.take_place());
}

TEST_F(FoxgloveShowTest, MalformedMessagesAndWrongNumbersDoNoHarm) {
  const auto viewer = show_.viewer(true);
  told(*viewer);
  EXPECT_FALSE(viewer->message("{", true));
  EXPECT_FALSE(viewer->message(std::string("\x05\0\0\0\0", 5), false));
  EXPECT_TRUE(viewer->message(subscribe(1, 4000000000U), true));
  EXPECT_EQ(told(*viewer).texts.at(0)["op"], "status");
  EXPECT_TRUE(viewer->message(R"({"op":"unsubscribe","subscriptionIds":[77]})", true));
  EXPECT_TRUE(viewer->message(R"({"op":"getParameters"})", true));
  for (int k = 0; k < 1000 && viewer->message(subscribe(1, 4000000000U), true); ++k) {
    EXPECT_LT(k, 200) << "answers to one who does not read are bounded";
  }
  show_.add(step(0));
}

}  // namespace
}  // namespace prospect::foxglove_show_test
