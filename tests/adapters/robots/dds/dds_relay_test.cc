// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_relay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_relay_test {
namespace {

using test::kPatience;
using test::within;

TEST(DdsRelay, PassesCommandsOnAndStopsTheRobotWhenTheyCease) {
  DdsOptions options;
  options.address = test::dds_test_address("relay");
  options.command.plain = "/cmd_vel_plain";
  options.command.relay = "/prospect/cmd_vel";
  options.command.dead_man = 0.5;
  options.command.limits = {0.5, 1.0, 100.0, 100.0};
  const SteadyClock clock;
  DdsNode motors(test::dds_test_address("motors"));
  std::atomic<int> driven = 0, stopped = 0, plain = 0;
  std::atomic<double> newest = 0.0, fastest = 0.0;
  motors.subscribe<ros::TwistStamped>("/cmd_vel", kCommandQos, [&](const ros::TwistStamped& m) {
    ++(m.twist.linear.x == 0.3 ? driven : stopped);
    newest = m.twist.linear.x;
    fastest = std::max(fastest.load(), m.twist.linear.x);
  });
  motors.subscribe<ros::Twist>("/cmd_vel_plain", kCommandQos,
                               [&](const ros::Twist& m) { plain += m.linear.x == 0.3; });
  motors.start();

  std::atomic<bool> ended = false;
  std::string told;
  std::mutex mutex;
  DdsRelay relay(options);
  std::thread runs([&] {
    relay.run([&] { return ended.load(); },
              [&](const std::string& line) {
                const std::lock_guard lock(mutex);
                told = line;
              });
  });
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DdsBase base(options, node, transforms, clock);
  node.start();
  EXPECT_NEAR(*base.dead_man(), 0.52, 1e-12);
  EXPECT_TRUE(within(kPatience, [&] {
    return node.subscribers("/prospect/cmd_vel") > 0 && motors.publishers("/cmd_vel") > 0 &&
           motors.publishers("/cmd_vel_plain") > 0;
  }));
  clock.wait_until(clock.now() + 0.15, {});
  EXPECT_EQ(stopped, 0) << "nothing is sent before the first command";

  base.send({{0.3, 0.0, 0.0}, 0.0}, clock.now() + 1.0);
  const double sent = clock.now();
  EXPECT_TRUE(within(kPatience, [&] { return driven == 1 && plain == 1; }));
  EXPECT_TRUE(within(kPatience, [&] { return stopped >= 3; })) << "again and again";
  EXPECT_GE(clock.now() - sent, 0.4) << "by its stamp, which is older";
  EXPECT_EQ(driven, 1);
  {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(told, "");
  }

  // Beyond the limits, too old by its stamp, and of a second commander.
  base.send({{50.0, 0.0, 0.0}, 0.0}, clock.now() + 1.0);
  EXPECT_TRUE(within(kPatience, [&] { return fastest > 0.3; }));
  EXPECT_LE(fastest, 0.5);
  EXPECT_TRUE(within(kPatience, [&] { return newest == 0.0; }));
  {
    DdsNode past(test::dds_test_address("past"));
    past.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
    past.start();
    EXPECT_TRUE(within(
        kPatience,
        [&] {
          const std::lock_guard lock(mutex);
          return told.find(
                     "2 publishers of commands: /prospect, /past on /cmd_vel; expected one") !=
                 std::string::npos;
        },
        [&] {
          base.send({{0.1, 0.0, 0.0}, 0.0}, clock.now() + 1.0);
        }))
        << "who commands the motors past it";
    EXPECT_TRUE(within(kPatience, [&] { return newest == 0.0; }));
  }
  DdsNode other(test::dds_test_address("other"));
  const int topic = other.advertise<ros::TwistStamped>("/prospect/cmd_vel", kCommandQos);
  other.start();
  EXPECT_TRUE(within(kPatience, [&] { return other.subscribers("/prospect/cmd_vel") > 0; }));
  const auto both_command = [&] {
    ros::TwistStamped command;
    command.twist.linear.x = 0.2;
    other.publish(topic, command);
    base.send({{0.1, 0.0, 0.0}, 0.0}, clock.now() + 1.0);
  };
  EXPECT_TRUE(within(
      kPatience,
      [&] {
        const std::lock_guard lock(mutex);
        return told.find("2 publishers of commands") != std::string::npos && newest == 0.0;
      },
      both_command));
  fastest = 0.0;
  EXPECT_FALSE(within(
      0.3, [&] { return fastest > 0.0; }, both_command));
  ended = true;
  runs.join();

  options.command.limits.acceleration.reset();
  EXPECT_THROW(DdsRelay{options}, InputError);
  options.command.relay.clear();
  EXPECT_THROW(DdsRelay{options}, InputError);
}

}  // namespace
}  // namespace prospect::dds_relay_test
