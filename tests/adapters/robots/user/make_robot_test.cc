// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/user/make_robot.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/robots/user/joined_robots.h"
#include "models/unicycle.h"
#include "tests/runtime/fake_base.h"

namespace prospect::make_robot_test {
namespace {

/// Tells one pose, then what it was told to do.
class OnePose final : public SensorSource {
 public:
  explicit OnePose(std::function<void(const std::stop_token&)> then) : then_(std::move(then)) {}
  void deliver(FrameSink& frames, const std::stop_token& stop) override {
    frames.observe(ExternalPose{.stamp = SteadyClock().now()});
    then_(stop);
  }

 private:
  std::function<void(const std::stop_token&)> then_;
};

void wait(const std::stop_token& stop) {
  SteadyClock().wait_until(SteadyClock().now() + 60.0, stop);
}

UserRobot user_robot(const std::function<void(const std::stop_token&)>& then) {
  UserRobot user;
  user.name = "mine";
  user.streams = {SensorStream::kPose};
  user.make = [then](const Options&) {
    static const SteadyClock clock;
    return RobotDrivers{.base = std::make_shared<test::FakeBase>(clock),
                        .sensors = {std::make_shared<OnePose>(then)}};
  };
  return user;
}

Robot made(const UserRobot& user, const std::vector<InjectedFault>& faults = {}) {
  UserRobotConfiguration options{.user = user, .robot = {}};
  options.robot.model = std::make_shared<const Unicycle>();
  options.inbox.poses_in_runtime_clock = true;
  options.faults = faults;
  return make_robot(options);
}

/// The first fault of the links, once there is one; tests share their machine.
std::string fault_of(const Robot& robot) {
  const SteadyClock clock;
  for (const double end = clock.now() + 20.0; clock.now() < end;) {
    if (const auto faults = robot.link_faults(); !faults.empty()) return faults.front();
    clock.wait_until(clock.now() + 0.005, {});
  }
  return "";
}

TEST(UserRobot, WhatItsSensorsDeliverComesThroughTheInboxAndTheyEndWithIt) {
  std::atomic<bool> ended{false};
  {
    const Robot robot = made(user_robot([&](const std::stop_token& stop) {
      wait(stop);
      ended = true;
    }));
    EXPECT_EQ(robot.name, "mine");
    EXPECT_EQ(robot.streams, std::vector<SensorStream>{SensorStream::kPose});
    ASSERT_TRUE(robot.frames->wait(20.0, {}));
    EXPECT_TRUE(std::holds_alternative<ExternalPose>(*robot.frames->take()));
    EXPECT_TRUE(robot.link_faults().empty());
    EXPECT_FALSE(ended);
  }
  EXPECT_TRUE(ended);
}

TEST(UserRobot, SensorsThatEndOrFailAreTold) {
  EXPECT_EQ(fault_of(made(user_robot([](const std::stop_token&) {}))), "the sensors have ended");
  EXPECT_EQ(fault_of(made(user_robot(
                [](const std::stop_token&) { throw std::runtime_error("no such device"); }))),
            "the sensors have failed: no such device");
}

TEST(UserRobot, FaultsStandBetweenItsBaseAndPoses) {
  const Robot robot = made(user_robot(wait), {{FaultSource::kLink, FaultVerb::kOff},
                                              {FaultSource::kCameras, FaultVerb::kOff}});
  EXPECT_EQ(robot.base->dead_man(), 0.5);
  EXPECT_FALSE(robot.frames->wait(0.1, {}));
  robot.base->send({{0.3, 0.0, 0.0}, 0.0}, SteadyClock().now() + 1.0);
  EXPECT_EQ(robot.base->report().velocity.linear.norm(), 0.0);
}

TEST(UserRobot, WithoutDriversItIsRefused) {
  UserRobot user = user_robot(wait);
  const auto make = user.make;
  for (const bool base : {false, true}) {
    user.make = [&](const Options& told) {
      RobotDrivers drivers = make(told);
      base ? drivers.base.reset() : drivers.sensors.clear();
      return drivers;
    };
    EXPECT_THROW(made(user), std::invalid_argument);
  }
  user.make = nullptr;
  EXPECT_THROW(made(user), std::invalid_argument);
}

// A camera alone, also with a pose of another, sees nothing that could be driven into.
TEST(UserRobot, WithoutRangesOrAPlaceItIsRefusedInALine) {
  using enum SensorStream;
  const auto refusal = [](const std::vector<SensorStream>& streams) -> std::string {
    UserRobot user = user_robot(wait);
    user.streams = streams;
    try {
      check_streams(user);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  for (const std::vector<SensorStream>& mono :
       {std::vector{kLeft, kPose}, {kLeft, kWheels}, {kPose}, {kPair, kWheels}, {}}) {
    const std::string why = refusal(mono);
    EXPECT_NE(why.find("measures ranges; expected depth or scan"), std::string::npos) << why;
    EXPECT_EQ(why.find('\n'), std::string::npos);
  }
  const std::string nowhere = refusal({kLeft, kScan});
  EXPECT_NE(nowhere.find("says where it is; expected pair, pose or wheels"), std::string::npos);
  for (const std::vector<SensorStream>& fit :
       {std::vector{kLeft, kPose, kScan}, {kPose, kDepth}, {kWheels, kDepth}, {kPair, kScan}}) {
    EXPECT_EQ(refusal(fit), "");
  }
}

TEST(UserRobot, OfPartsEachOfWhichBringsWhatTheOtherLacks) {
  UserRobot base = user_robot(wait), sensors = user_robot(wait);
  sensors.name = "eyes";
  sensors.streams = {SensorStream::kPose, SensorStream::kScan};
  base.options = {{"port", 1, ""}};
  sensors.options = {{"rate", 2, ""}};
  base.make = [make = base.make](const Options& told) { return RobotDrivers{make(told).base, {}}; };
  const UserRobot twice = joined({base, user_robot(wait)});
  sensors.make = [make = sensors.make](const Options& told) {
    EXPECT_EQ(std::get<int>(told.at("port")), 7);
    return RobotDrivers{nullptr, make(told).sensors};
  };
  const UserRobot whole = joined({base, sensors});
  EXPECT_EQ(whole.name, "mine-eyes");
  EXPECT_EQ(whole.streams, sensors.streams);
  EXPECT_EQ(whole.options.size(), 2u);
  UserRobotConfiguration options{.user = whole, .robot = {}};
  options.robot.model = std::make_shared<const Unicycle>();
  options.options = {{"port", 7}, {"rate", 2}};
  const Robot robot = make_robot(options);
  EXPECT_EQ(robot.base->name(), "fake");
  // What two of them have is nobody's to choose.
  EXPECT_THROW(made(twice), std::invalid_argument);
  sensors.options.front().name = "port";
  EXPECT_THROW(joined({base, sensors}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::make_robot_test
