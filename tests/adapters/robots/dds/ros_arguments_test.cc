// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/ros_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/dds/dds_options.h"

namespace prospect::ros_arguments_test {
namespace {

using ::testing::HasSubstr;

const std::string kRest = "command: {dead_man: 0.5}\n";

DdsOptions read(const std::string& text, const RosArguments& arguments) {
  const std::string path = ::testing::TempDir() + "ros_arguments_test.yaml";
  std::ofstream(path) << text;
  return read_dds_options(path, arguments);
}
std::string refusal(const std::string& text, const RosArguments& arguments) {
  try {
    read(text, arguments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RosArguments, TheEnvironmentStandsBelowTheFile) {
  const RosArguments environment{"7", "<CycloneDDS/>", {}, {}};
  EXPECT_EQ(read(kRest, environment).address.domain, 7);
  EXPECT_EQ(read(kRest, environment).address.uri, "<CycloneDDS/>");
  EXPECT_EQ(read("domain: 3\n" + kRest, environment).address.domain, 3);
  EXPECT_EQ(read("loopback: true\n" + kRest, environment).address.uri, "");
  EXPECT_EQ(read(kRest, {}).address.domain, 0);
  EXPECT_EQ(read(kRest, {"", "", {"__ns:=/"}, {}}).odometry, "/odom");
  EXPECT_THAT(refusal(kRest, {"seven", "", {}, {}}), HasSubstr("ROS_DOMAIN_ID seven"));
  EXPECT_THAT(refusal(kRest, {"233", "", {}, {}}), HasSubstr("ROS_DOMAIN_ID 233"));
}

TEST(RosArguments, ArgumentsStandAboveTheFile) {
  const RosArguments arguments{"",
                               "",
                               {"__ns:=/r", "__node:=n", "/odom:=wheels", "cmd_vel:=/drive"},
                               {"use_sim_time:=true"}};
  const DdsOptions o = read("namespace: /a\nnode: b\nodometry: /odom\n" + kRest, arguments);
  EXPECT_EQ(o.address.its_namespace, "/r");
  EXPECT_EQ(o.address.node, "n");
  EXPECT_EQ(o.odometry, "/r/wheels");
  EXPECT_EQ(o.command.stamped, "/drive");
  EXPECT_EQ(o.goal, "/r/goal_pose");
  EXPECT_TRUE(o.use_sim_time);
  EXPECT_EQ(o.clock, "/r/clock");
  EXPECT_EQ(o.command.relay_age, DdsOptions::RelayAge::kArrival);
}

TEST(RosArguments, EachTopicCanBeRenamed) {
  for (const char* topic : {"/tf",
                            "/tf_static",
                            "/left/image_rect",
                            "/left/camera_info",
                            "/right/image_rect",
                            "/right/camera_info",
                            "/depth/image_rect_raw",
                            "/depth/camera_info",
                            "/odom",
                            "/cmd_vel",
                            "/goal_pose",
                            "/prospect/command",
                            "/prospect",
                            "/prospect/navigate_to_pose",
                            "/prospect/path",
                            "/map",
                            "/octomap_binary",
                            "/prospect/markers",
                            "/diagnostics",
                            "/prospect/state"}) {
    EXPECT_EQ(refusal(kRest, {"", "", {std::string(topic) + ":=/other"}, {}}), "accepted") << topic;
  }
}

TEST(RosArguments, WhatIsNoneIsNamed) {
  const auto of = [](const char* rule) { return refusal(kRest, {"", "", {rule}, {}}); };
  EXPECT_THAT(of("/odom=/x"), HasSubstr("-r /odom=/x: no rule; expected FROM:=TO"));
  EXPECT_THAT(of("/odm:=/x"), HasSubstr("-r /odm:=/x: no topic of that name"));
  EXPECT_THAT(of("/odom:=/cmd_vel"), HasSubstr("has another meaning already"));
  EXPECT_THAT(of("/odom:=/a b"), HasSubstr("expected a name of ROS 2"));
  EXPECT_THAT(of("__node:=a/b"), HasSubstr("-r __node:=a/b"));
  EXPECT_THAT(of("__ns:=a b"), HasSubstr("-r __ns:=a b"));
  EXPECT_THAT(refusal(kRest, {"", "", {}, {"rate:=3"}}), HasSubstr("no such parameter"));
  EXPECT_THAT(refusal(kRest, {"", "", {}, {"use_sim_time:=maybe"}}),
              HasSubstr("-p use_sim_time:=maybe"));
  EXPECT_THAT(refusal("clock: /clock\n" + kRest, {}), HasSubstr("yaml:1: clock"));
  EXPECT_THAT(refusal("command: {dead_man: 0.5, relay_age: stamp}\nuse_sim_time: true\n", {}),
              HasSubstr("expected arrival"));
}

}  // namespace
}  // namespace prospect::ros_arguments_test
