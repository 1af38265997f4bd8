#include "adapters/dds/dds_relay.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

#include "adapters/dds/dds_base.h"
#include "adapters/dds/dds_node.h"
#include "adapters/files/input_error.h"
#include "adapters/ros/geometry_msgs.h"
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
  options.command.dead_man = 0.1;
  const SteadyClock clock;
  DdsNode motors(test::dds_test_address("motors"));
  std::atomic<int> driven = 0, stopped = 0, plain = 0;
  motors.subscribe<ros::TwistStamped>("/cmd_vel", kCommandQos, [&](const ros::TwistStamped& m) {
    ++(m.twist.linear.x == 0.3 ? driven : stopped);
  });
  motors.subscribe<ros::Twist>("/cmd_vel_plain", kCommandQos,
                               [&](const ros::Twist& m) { plain += m.linear.x == 0.3; });
  motors.start();

  std::atomic<bool> ended = false;
  std::string told;
  DdsRelay relay(options);
  std::thread runs([&] {
    relay.run([&] { return ended.load(); }, [&](const std::string& line) { told = line; });
  });
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DdsBase base(options, node, transforms, clock);
  node.start();
  EXPECT_NEAR(*base.dead_man(), 0.12, 1e-12);
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
  EXPECT_GE(clock.now() - sent, 0.1);
  EXPECT_EQ(driven, 1);
  ended = true;
  runs.join();
  EXPECT_EQ(told, "");

  options.command.relay.clear();
  EXPECT_THROW(DdsRelay{options}, InputError);
}

}  // namespace
}  // namespace prospect::dds_relay_test
