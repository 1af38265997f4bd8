// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/gazebo/velocity_relay.h"
#include "tests/adapters/fake_gazebo.h"

namespace prospect::gazebo_base_test {
namespace {

using test::FakeGazebo;
using test::soon;
using ::testing::Contains;
using ::testing::HasSubstr;

const std::string kPoses = "/gazebo/room/pose/info";

/// Waits for a velocity of that speed.
bool comes(FakeGazebo& gazebo, double speed) {
  return soon([&] {
    const auto all = gazebo.velocities();
    return std::any_of(all.begin(), all.end(), [&](const auto& v) { return v.first == speed; });
  });
}

gazebo::msgs::PosesStamped wheels_at(double stamp, double angle) {
  gazebo::msgs::PosesStamped message;
  FakeGazebo::stamp(message, stamp);
  for (const char* name : {"robot::left_wheel", "robot::right_wheel"}) {
    gazebo::msgs::Pose* const pose = message.add_pose();
    pose->set_name(name);
    pose->mutable_position()->set_x(0.0);
    pose->mutable_position()->set_y(0.0);
    pose->mutable_position()->set_z(0.0);
    pose->mutable_orientation()->set_x(0.0);
    pose->mutable_orientation()->set_y(std::sin(0.5 * angle));
    pose->mutable_orientation()->set_z(0.0);
    pose->mutable_orientation()->set_w(std::cos(0.5 * angle));
  }
  return message;
}

struct Driven {
  Driven() : base(std::make_unique<GazeboBase>(gazebo.options(), clock)) {
    connected = soon([&] {
      gazebo.publish(kPoses, wheels_at(stamp += 0.01, 0.0));
      return base->report().connected;
    });
  }
  FakeGazebo gazebo;
  SteadyClock machine;
  SimulationClock clock{machine};
  std::unique_ptr<GazeboBase> base;
  double stamp = 0.0;
  bool connected = false;
};

TEST(GazeboBase, PassesCommandsOnAndStopsOnSilence) {
  Driven d;
  ASSERT_TRUE(d.connected);
  ASSERT_TRUE(d.base->dead_man());
  d.gazebo.velocities();
  d.base->send({{0.5, 0.0, 0.0}, 0.25}, d.clock.now() + 10.0);
  std::vector<std::pair<double, double>> all;
  ASSERT_TRUE(soon([&] {
    for (const auto& v : d.gazebo.velocities()) all.push_back(v);
    return std::any_of(all.begin(), all.end(), [](const auto& v) { return v.first == 0.5; });
  }));
  const auto moved =
      std::find_if(all.begin(), all.end(), [](const auto& v) { return v.first == 0.5; });
  EXPECT_NEAR(moved->second, -0.25, 1e-12);
  // Nothing more comes from us: zero, again and again.
  EXPECT_TRUE(comes(d.gazebo, 0.0));
  EXPECT_TRUE(comes(d.gazebo, 0.0));
}

TEST(GazeboBase, PassesNothingOnThatHasExpired) {
  Driven d;
  ASSERT_TRUE(d.connected);
  d.base->send({{0.5, 0.0, 0.0}, 0.0}, d.clock.now() - 0.001);
  d.base->send({{std::nan(""), 0.0, 0.0}, 0.0}, d.clock.now() + 10.0);
  d.base->send({{0.25, 0.0, 0.0}, 0.0}, d.clock.now() + 10.0);
  std::vector<double> speeds;
  ASSERT_TRUE(soon([&] {
    for (const auto& v : d.gazebo.velocities()) speeds.push_back(v.first);
    return std::count(speeds.begin(), speeds.end(), 0.25) > 0;
  }));
  for (const double speed : speeds) EXPECT_TRUE(speed == 0.0 || speed == 0.25) << speed;
}

TEST(GazeboBase, ReportsWhatItsWheelsDo) {
  Driven d;
  ASSERT_TRUE(d.connected);
  const double turned = d.stamp + 0.1;
  d.gazebo.publish(kPoses, wheels_at(turned, 0.5));
  // What was published before may still be under way.
  BaseReport report;
  ASSERT_TRUE(soon([&] {
    report = d.base->report();
    return !report.wheels.empty() && std::abs(report.wheels.back().stamp - turned) < 1e-9;
  }));
  EXPECT_NEAR(report.wheels.back().velocity.x(), 0.4, 1e-6);
  EXPECT_NEAR(report.velocity.linear.x(), 0.4, 1e-6);
  EXPECT_TRUE(report.faults.empty());
  EXPECT_TRUE(d.base->report().wheels.empty());
}

TEST(GazeboBase, AGazeboThatEndsIsAFault) {
  Driven d;
  ASSERT_TRUE(d.connected);
  d.gazebo.end();
  BaseReport report;
  ASSERT_TRUE(soon([&] { return (report = d.base->report()).faults.size() >= 2; }));
  EXPECT_FALSE(report.connected);
  EXPECT_THAT(report.faults, Contains(HasSubstr("master")));
}

TEST(GazeboBase, ARelayThatEndsIsAFault) {
  Driven d;
  ASSERT_TRUE(d.connected);
  ::kill(d.base->relay_process(), SIGKILL);
  BaseReport report;
  ASSERT_TRUE(soon([&] { return !(report = d.base->report()).faults.empty(); }));
  EXPECT_FALSE(report.connected);
  EXPECT_THAT(report.faults, Contains(HasSubstr("relay has ended")));
}

TEST(GazeboBase, ASilentRelayIsAFaultByTheTimeOfTheSimulation) {
  Driven d;
  ASSERT_TRUE(d.connected);
  const auto looks = [&](double step) {
    d.gazebo.publish(kPoses, wheels_at(d.stamp += step, 0.0));
    EXPECT_TRUE(soon([&] { return d.clock.now() >= d.stamp; }));
    return d.base->report();
  };
  ::kill(d.base->relay_process(), SIGSTOP);
  // The machine has no time for the relay and little for the world.
  for (int k = 0; k < 13; ++k) {
    ::usleep(100000);
    const BaseReport report = looks(0.01);
    EXPECT_TRUE(report.connected);
    EXPECT_TRUE(report.faults.empty()) << report.faults.front();
    EXPECT_LE(d.clock.now() - report.stamp, 0.5) << "the wheels are no older than the world";
  }
  BaseReport report;
  for (int k = 0; k < 40 && report.faults.empty(); ++k) report = looks(0.05);
  EXPECT_FALSE(report.connected);
  EXPECT_THAT(report.faults, Contains(HasSubstr("relay is silent")));
  ::kill(d.base->relay_process(), SIGCONT);
  EXPECT_TRUE(soon([&] { return d.base->report().faults.empty(); }));
}

TEST(VelocityRelay, StopsTheRobotOfAnOwnerWhoWasKilled) {
  FakeGazebo gazebo;
  GazeboOptions options = gazebo.options();
  options.dead_man = 100.0;
  const int owner = ::fork();
  if (owner == 0) {
    VelocityRelay relay(options);
    for (int n = 0; n < 500 && !relay.state(0.0).connected; ++n) ::usleep(10000);
    relay.send({{0.5, 0.0, 0.0}, 0.0}, SteadyClock().now() + 100.0);
    for (;;) ::pause();
  }
  ASSERT_GT(owner, 0);
  EXPECT_TRUE(comes(gazebo, 0.5));
  gazebo.velocities();
  ::kill(owner, SIGKILL);
  ::waitpid(owner, nullptr, 0);
  EXPECT_TRUE(comes(gazebo, 0.0));
}

TEST(VelocityRelay, SaysWhatItCannotReach) {
  GazeboOptions options;
  options.address.port = 1;
  try {
    VelocityRelay relay(options);
    FAIL() << "it runs";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.0.1:1"));
  }
  options.dead_man = 0.0;
  options.wheel_radius = -1.0;
  try {
    VelocityRelay relay(options);
    FAIL() << "it runs";
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 2u);
  }
}

}  // namespace
}  // namespace prospect::gazebo_base_test
