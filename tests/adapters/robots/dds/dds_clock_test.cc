// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stop_token>
#include <thread>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/rosgraph_msgs.h"
#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_clock_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

constexpr double kBegin = 5000.0;  // [s] of the simulation

/// A simulation that publishes its time at 50 Hz, at half the speed of the machine's clock.
class Simulation {
 public:
  Simulation() : node_(test::dds_test_address("simulation")) {
    topic_ = node_.advertise<ros::Clock>("/clock", kReliableQos);
    node_.start();
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (!stands_) time_ = time_ + 0.01;
        node_.publish(topic_, ros::Clock{ros::time_of(time_)});
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
  }
  double time() const { return time_; }
  void stand() { stands_ = true; }

 private:
  std::atomic<double> time_{kBegin};
  std::atomic<bool> stands_{false};
  DdsNode node_;
  int topic_ = -1;
  std::jthread thread_;  // ends first
};

TEST(DdsClock, TimeIsTheSimulationsAndSoAreTheStampsOfCommands) {
  Simulation simulation;
  const DdsClock time(test::dds_test_address("prospect"), "/clock", kPatience);
  const Clock& clock = time.clock();
  EXPECT_GE(clock.now(), kBegin);
  EXPECT_TRUE(within(kPatience, [&] { return clock.now() > kBegin + 0.3; }));
  EXPECT_LE(clock.now(), simulation.time() + 0.2);

  DdsOptions options;
  options.use_sim_time = true;
  options.command.dead_man = 0.5;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DdsBase base(options, node, transforms, clock);
  node.start();
  DdsNode driver(test::dds_test_address("driver"));
  std::atomic<double> stamp = 0.0;
  driver.subscribe<ros::TwistStamped>(
      options.command.stamped, kCommandQos,
      [&](const ros::TwistStamped& m) { stamp = ros::seconds(m.header.stamp); });
  driver.start();
  ASSERT_TRUE(within(
      kPatience, [&] { return stamp > 0.0; },
      [&] {
        base.send({{0.1, 0.0, 0.0}, 0.0}, clock.now() + 0.2);
      }));
  EXPECT_GE(stamp, kBegin);
  EXPECT_LE(stamp, simulation.time() + 0.2);

  // A world that stands stops the time.
  simulation.stand();
  const double stood = simulation.time();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_NEAR(clock.now(), stood, 0.15);
}

TEST(DdsClock, WithoutATimeNothingBegins) {
  try {
    const DdsClock none(test::dds_test_address("prospect"), "/clock", 0.05);
    FAIL() << "it begins";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/clock: no message within 0.05 s; expected the time"));
  }
}

}  // namespace
}  // namespace prospect::dds_clock_test
