// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/std_msgs.h"
#include "runtime/clock.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_node_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

TEST(DdsNode, WhatOnePublishesTheOtherHears) {
  DdsNode ours(test::dds_test_address("ours"));
  std::atomic<double> speed = 0.0;
  std::atomic<int> stops = 0, late = 0;
  ours.subscribe<ros::TwistStamped>("/cmd_vel", kCommandQos, [&](const ros::TwistStamped& m) {
    if (m.header.frame_id == "base_link") speed = m.twist.linear.x;
  });
  ours.subscribe<ros::Bool>("/stop", kReliableQos, [&](const ros::Bool& m) { stops += m.data; });
  ours.start();

  DdsNode theirs(test::dds_test_address("theirs"));
  const int command = theirs.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
  const int stop = theirs.advertise<ros::Bool>("/stop", kReliableQos);
  const int map = theirs.advertise<ros::String>("/map_name", kLatchedQos);
  theirs.start();
  EXPECT_TRUE(theirs.publish(map, ros::String{"office"}));

  ASSERT_TRUE(within(kPatience, [&] {
    return theirs.subscribers("/cmd_vel") == 1 && theirs.subscribers("/stop") == 1 &&
           ours.publishers("/cmd_vel") == 1;
  }));
  ros::TwistStamped m;
  m.header.frame_id = "base_link";
  m.twist.linear.x = 0.25;
  EXPECT_TRUE(theirs.publish(command, m));
  EXPECT_TRUE(theirs.publish(stop, ros::Bool{true}));
  EXPECT_TRUE(within(kPatience, [&] { return speed == 0.25 && stops == 1; }));

  // Who comes later hears what is latched.
  DdsNode third(test::dds_test_address("third"));
  third.subscribe<ros::String>("/map_name", kLatchedQos,
                               [&](const ros::String& name) { late += name.data == "office"; });
  third.start();
  EXPECT_TRUE(within(kPatience, [&] { return late == 1; }));
  EXPECT_TRUE(ours.faults().empty());
  EXPECT_TRUE(theirs.faults().empty());
  EXPECT_FALSE(theirs.publish(-1, ros::Bool{true})) << "a topic that is not used";
  EXPECT_FALSE(ours.publish(0, ros::Bool{true})) << "a subscription";
}

TEST(DdsNode, WhatIsNoMessageIsAFaultUntilAGoodOneComes) {
  DdsNode ours(test::dds_test_address("ours"));
  std::atomic<int> good = 0;
  ours.subscribe<ros::TwistStamped>("/cmd_vel", kCommandQos,
                                    [&](const ros::TwistStamped&) { ++good; });
  ours.start();
  DdsNode theirs(test::dds_test_address("theirs"));
  const int command = theirs.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
  theirs.start();
  ASSERT_TRUE(within(kPatience, [&] { return theirs.subscribers("/cmd_vel") == 1; }));

  const std::string whole = ros::to_cdr(ros::TwistStamped());
  struct Row {
    std::string bytes;
    const char* expected;
  };
  const Row rows[] = {{std::string("\0\1\0\0", 4), "/cmd_vel: the message ends early"},
                      {whole.substr(0, whole.size() - 8), "/cmd_vel: the message ends early"},
                      {std::string(200, '\xff'), "/cmd_vel: no message in CDR"},
                      {"", "/cmd_vel: no message in CDR"}};
  for (const Row& row : rows) {
    const int before = good;
    EXPECT_TRUE(within(
        kPatience, [&] { return !ours.fault("/cmd_vel").empty(); },
        [&] { theirs.publish(command, row.bytes); }));
    EXPECT_THAT(ours.fault("/cmd_vel"), HasSubstr(row.expected));
    EXPECT_EQ(good, before);
    EXPECT_TRUE(within(
        kPatience, [&] { return good > before + 8 && ours.fault("/cmd_vel").empty(); },
        [&] { theirs.publish(command, whole); }));
    // One alone decides nothing.
    const int then = good;
    EXPECT_TRUE(theirs.publish(command, row.bytes));
    EXPECT_TRUE(within(
        kPatience, [&] { return good > then; },
        [&] {
          EXPECT_EQ(ours.fault("/cmd_vel"), "");
          theirs.publish(command, whole);
        }));
  }
}

TEST(DdsNode, AnotherTypeOrQosOnATopicIsNamed) {
  DdsNode ours(test::dds_test_address("ours"));
  ours.subscribe<ros::Bool>("/stop", kReliableQos, [](const ros::Bool&) {});
  ours.subscribe<ros::Bool>("/other", kReliableQos, [](const ros::Bool&) {});
  ours.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
  ours.start();
  {
    DdsNode theirs(test::dds_test_address("theirs"));
    theirs.advertise<ros::Bool>("/stop", kSensorQos);
    theirs.advertise<ros::String>("/other", kReliableQos);
    theirs.subscribe<ros::Twist>("/cmd_vel", kCommandQos, [](const ros::Twist&) {});
    theirs.start();
    EXPECT_TRUE(within(kPatience, [&] { return ours.faults().size() == 3; }));
    EXPECT_EQ(ours.fault("/stop"),
              "/stop: reliability of another node's publisher does not fit; expected one that fits "
              "a subscription that is reliable, volatile");
    EXPECT_EQ(ours.fault("/other"),
              "/other: another node publishes std_msgs/msg/String; expected std_msgs/msg/Bool");
    EXPECT_EQ(ours.fault("/cmd_vel"),
              "/cmd_vel: another node expects geometry_msgs/msg/Twist; expected "
              "geometry_msgs/msg/TwistStamped");
  }
  EXPECT_TRUE(within(kPatience, [&] {
    return ours.fault("/other").empty() && ours.fault("/cmd_vel").empty();
  })) << "it is gone";
}

TEST(DdsNode, RefusesWhatCannotBe) {
  DdsNode node(test::dds_test_address());
  EXPECT_THROW(node.advertise<ros::Bool>("stop", kReliableQos), InputError);
  DdsAddress missing = test::dds_test_address();
  missing.domain += 100;
  missing.configuration = "/no/such/file.xml";
  EXPECT_THROW(DdsNode{missing}, InputError);
}

// A dead publisher counted as a second commander for 10 s.
TEST(DdsNode, AProcessThatWasKilledIsGoneAfterItsLease) {
  const DdsAddress address = test::dds_test_address("ours");
  const int child = ::fork();
  if (child == 0) {
    DdsNode node(address);
    node.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
    node.start();
    for (;;) ::pause();
  }
  ASSERT_GT(child, 0);
  DdsNode ours(address);
  ours.watch("/cmd_vel");
  ours.start();
  const auto seen = [&] { return ours.publisher_names("/cmd_vel").size(); };
  EXPECT_TRUE(within(kPatience, [&] { return seen() == 1; }));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  const SteadyClock clock;
  const double killed = clock.now();
  EXPECT_TRUE(within(kPatience, [&] { return seen() == 0; }));
  EXPECT_LT(clock.now() - killed, 5.0);
}

// CYCLONEDDS_URI stands above what the program sets. A domain is configured once in a process, so
// these are domains of their own.
TEST(DdsNode, TheEnvironmentsConfigurationStandsAboveItsOwn) {
  const std::string log = ::testing::TempDir() + "cyclonedds_uri_" + std::to_string(getpid());
  DdsAddress address = test::dds_test_address("ours");
  address.domain += 91;
  address.uri =
      "<CycloneDDS><Domain><General><MaxMessageSize>4321B</MaxMessageSize></General><Tracing>"
      "<Verbosity>config</Verbosity><OutputFile>" +
      log + "</OutputFile></Tracing></Domain></CycloneDDS>";
  { DdsNode node(address); }
  std::ostringstream told;
  told << std::ifstream(log).rdbuf();
  std::filesystem::remove(log);
  EXPECT_THAT(told.str(), HasSubstr("General/MaxMessageSize/#text: 4321 B"));
  EXPECT_THAT(told.str(), HasSubstr("General/FragmentSize/#text: 60000 B")) << "the rest stays";
  EXPECT_THAT(told.str(), HasSubstr("Discovery/LeaseDuration/#text: 2 s"));
  address.domain += 1;
  address.uri = "<CycloneDDS><Domain><NoSuchThing/></Domain></CycloneDDS>";
  try {
    DdsNode node(address);
    FAIL() << "it takes it";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("CYCLONEDDS_URI <CycloneDDS>"));
  }
}

TEST(DdsNode, TakesTheConfigurationOfTheSamplePackage) {
  DdsAddress address = test::dds_test_address();
  address.configuration =
      std::string(PROSPECT_SOURCE_DIR) + "/share/ros2/prospect_robot/config/cyclonedds.xml";
  EXPECT_NO_THROW(DdsNode{address});
}

}  // namespace
}  // namespace prospect::dds_node_test
