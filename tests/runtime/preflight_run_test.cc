// SPDX-License-Identifier: Apache-2.0
#include "runtime/preflight_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/runtime/fake_base.h"
#include "tests/runtime/patient_guard.h"

namespace prospect::preflight_run_test {
namespace {

using Verdict = CheckVerdict;

/// Knows where the base is, up to a gain of its yaw, in a given world.
class Beliefs final : public BeliefSource {
 public:
  Beliefs(const Clock& clock, test::FakeBase& base) : clock_(clock), base_(base) {}
  std::shared_ptr<const Belief> update(const std::stop_token& stop) override {
    clock_.wait_until(clock_.now() + 0.005, stop);
    auto belief = std::make_shared<Belief>(world);
    belief->set_stamps(silent ? 0.0 : clock_.now());
    belief->pose = base_.pose();
    belief->pose.yaw *= gain;
    belief->pose.position *= way_gain;
    // Once it has begun to turn it drives, too.
    if (runs > 0.0 && belief->pose.yaw > 0.01) {
      if (!runs_since) runs_since = clock_.now();
      belief->pose.position.x() += runs * (clock_.now() - *runs_since);
    }
    belief->localization = lost ? Localization::kLost : Localization::kOk;
    if (gyro != nullptr) {
      ImuSample sample;
      sample.stamp = clock_.now();
      sample.angular_velocity.z() = gyro_gain * base_.velocity().yaw_rate + 0.05;
      sample.linear_acceleration.x() = 1e-3 * std::sin(1e3 * sample.stamp);
      gyro->observe(sample);
    }
    return belief;
  }
  Belief world = test::ObstacleWorld().belief();
  double gain = 1.0, way_gain = 1.0, runs = 0.0;  // [m/s]
  std::optional<double> runs_since;
  bool lost = false;
  SensorInbox* gyro = nullptr;  // of who has one
  double gyro_gain = 1.0;
  std::atomic<bool> silent{false};

 private:
  const Clock& clock_;
  test::FakeBase& base_;
};

class PreflightRun : public ::testing::Test {
 protected:
  PreflightRun() {
    options_.checks.live_time = 0.05;
    options_.patience = 2.0;
    options_.turn = 0.12;
    options_.turn_rate = 0.6;
    options_.distance = 0.03;
    options_.speed = 0.3;
    options_.settle = 0.1;
    driver_.command.period = 0.02;
  }
  PreflightResult make() {
    const DriverParts parts{.clock = clock_,
                            .guard = guard_,
                            .model = model_,
                            .dead_man = base_.dead_man(),
                            .inbox = beliefs_.gyro,
                            .ranges = ranges_,
                            .emergency_stop = button_,
                            .streams = {{"cameras", 0.5,
                                         [](const Belief* newest) {
                                           return newest ? std::optional(newest->stamps.pose)
                                                         : std::nullopt;
                                         }}},
                            .requests = requests_};
    return run_preflight(parts, base_, beliefs_, options_, driver_,
                         {.floor = floor_, .observers = observers_, .cancelled = cancelled_});
  }
  static CheckResult check(const PreflightResult& result, const std::string& name) {
    for (const CheckResult& c : result.checks) {
      if (c.check == name) return c;
    }
    ADD_FAILURE() << "no check '" << name << "'";
    return {};
  }

  SteadyClock clock_;
  test::FakeBase base_{clock_};
  Beliefs beliefs_{clock_, base_};
  std::shared_ptr<const Unicycle> model_ = std::make_shared<const Unicycle>();
  Guard guard_ = test::patient_guard(model_);
  std::function<RangeCheck(const Twist&, double)> ranges_;
  std::function<bool()> cancelled_;
  std::function<std::optional<PreflightFacts::Floor>()> floor_;
  std::vector<MissionObserver*> observers_;
  DriveRequests* requests_ = nullptr;
  const EmergencyStopInput* button_ = nullptr;
  PreflightRunOptions options_;
  DriverOptions driver_;
};

TEST_F(PreflightRun, TurnsAndCompares) {
  const PreflightResult result = make();
  EXPECT_TRUE(result.yaw_checked);
  EXPECT_EQ(first_failed(result.checks), "") << to_text(result.checks);
  for (const char* name :
       {"yaw of the wheels", "yaw of the pose", "slip", "way of the wheels", "way of the pose"}) {
    EXPECT_NE(check(result, name).verdict, Verdict::kNotPossible) << check(result, name).why;
  }
  EXPECT_GT(base_.pose().yaw, 0.1);
  EXPECT_GT(base_.pose().position.norm(), 0.025);
  EXPECT_EQ(check(result, "emergency stop").verdict, Verdict::kNotPossible);
  EXPECT_NEAR(base_.velocity().yaw_rate, 0.0, 1e-9);
}

TEST_F(PreflightRun, CamerasThatTurnTheOtherWayFail) {
  beliefs_.gain = -1.0;
  const PreflightResult result = make();
  EXPECT_EQ(first_failed(result.checks), "yaw of the pose") << to_text(result.checks);
  EXPECT_EQ(check(result, "yaw of the wheels").verdict == Verdict::kFailed, false);
}

TEST_F(PreflightRun, AGyroThatTurnsTheOtherWayFails) {
  SensorInbox inbox(clock_, in_runtime_clock(SensorInboxOptions()));
  beliefs_.gyro = &inbox;
  options_.checks.live_time = 0.8;
  EXPECT_EQ(check(make(), "yaw of the gyro").verdict, Verdict::kPassed);
  beliefs_.gyro_gain = -1.0;
  EXPECT_EQ(first_failed(make().checks), "yaw of the gyro");
}

TEST_F(PreflightRun, ABaseThatDrivesTheOtherWayFails) {
  beliefs_.way_gain = -1.0;
  const PreflightResult result = make();
  EXPECT_EQ(first_failed(result.checks), "way of the pose") << to_text(result.checks);
  EXPECT_TRUE(result.yaw_checked);
}

TEST_F(PreflightRun, ABaseThatRunsAwayIsStoppedAtOnce) {
  beliefs_.runs = 1.0;
  const PreflightResult result = make();
  EXPECT_EQ(first_failed(result.checks), "following") << to_text(result.checks);
  EXPECT_LT(base_.pose().yaw, 0.12);
}

TEST_F(PreflightRun, TurnsWhereThereIsNoRoomAhead) {
  ranges_ = [](const Twist& told, double) {
    return told.linear.x() > 0.0 ? RangeCheck{0.0, "a wall"} : RangeCheck{};
  };
  const PreflightResult result = make();
  EXPECT_TRUE(result.yaw_checked);
  EXPECT_EQ(check(result, "way of the wheels").verdict, Verdict::kNotPossible);
  EXPECT_NE(check(result, "way of the wheels").why.find("no way: a wall"), std::string::npos);
  EXPECT_LT(base_.pose().position.norm(), 0.02);
}

TEST_F(PreflightRun, ABaseThatCannotBeDrivenFailsAndIsNotMoved) {
  options_.patience = 0.2;
  base_.set_fault(
      "/cmd_vel: published by /prospect (this program), /teleop; expected one publisher");
  PreflightResult result = make();
  EXPECT_EQ(first_failed(result.checks), "base");
  EXPECT_NE(check(result, "base").why.find("/teleop"), std::string::npos);
  base_.disconnect();
  result = make();
  EXPECT_EQ(check(result, "base").why, "it is not connected");
  EXPECT_EQ(base_.pose().yaw, 0.0);
}

TEST_F(PreflightRun, OneLookAtTheFloorThatIsWrongDecidesNothing) {
  driver_.priority = 0;
  options_.turn = options_.distance = 0.0;
  const PreflightFacts::Floor good{0.4, 0.401, 0.0, 0.0, 0.0, 0.0, 0.001, 0.001};
  PreflightFacts::Floor wrong = good;
  for (const double height : {0.1, 0.9, std::nan("")}) {
    wrong.height = height;
    for (int which = 0; which < 3; ++which) {
      int look = 0;
      floor_ = [&] { return std::optional(look++ == which ? wrong : good); };
      EXPECT_EQ(check(make(), "camera height").verdict, Verdict::kPassed) << height;
    }
    int look = 0;
    floor_ = [&] { return std::optional(look++ == 0 ? good : wrong); };
    EXPECT_EQ(check(make(), "camera height").verdict, Verdict::kFailed) << height;
  }
  // Of frames of their own: what comes in between.
  std::vector<double> looked;
  std::vector<std::size_t> told;
  floor_ = [&] {
    looked.push_back(clock_.now());
    told.push_back(base_.sent().size());
    return std::optional(good);
  };
  make();
  ASSERT_EQ(looked.size(), 3u);
  for (std::size_t k = 1; k < looked.size(); ++k) {
    EXPECT_GE(looked[k] - looked[k - 1], 0.2);
    EXPECT_GT(told[k], told[k - 1]) << "it is told to stand";
    EXPECT_LE(static_cast<double>(told[k] - told[k - 1]),
              2.0 + (looked[k] - looked[k - 1]) / driver_.command.period);
  }
  floor_ = [&, look = 0]() mutable { return look++ == 0 ? std::optional(good) : std::nullopt; };
  EXPECT_EQ(check(make(), "camera height").verdict, Verdict::kNotPossible);
  EXPECT_EQ(check(make(), "priority of commands").verdict, Verdict::kNotPossible);
}

TEST_F(PreflightRun, ObserversAreToldOfBeliefs) {
  struct Observer final : MissionObserver {
    void on_belief(const Belief&) override { ++beliefs; }
    std::atomic<int> beliefs{0};
  } observer;
  observers_ = {&observer};
  options_.turn = options_.distance = 0.0;
  make();
  EXPECT_GT(observer.beliefs, 0);
}

TEST_F(PreflightRun, WaitsForWhoMayPressTheEmergencyStop) {
  EmergencyStopInput button("/stop", {.max_age = 10.0});
  button_ = &button;
  options_.patience = 0.1;
  EXPECT_EQ(first_failed(make().checks), "emergency stop") << "nobody";
  EXPECT_EQ(base_.pose().yaw, 0.0);
  button.told(1, true, clock_.now());
  EXPECT_EQ(first_failed(make().checks), "emergency stop") << "pressed";
  EXPECT_EQ(base_.pose().yaw, 0.0);
  options_.patience = 5.0;
  std::jthread late([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    button.told(1, false, clock_.now());
  });
  const PreflightResult result = make();
  EXPECT_EQ(check(result, "emergency stop").verdict, Verdict::kPassed);
  EXPECT_EQ(first_failed(result.checks), "");
}

TEST_F(PreflightRun, WhatCannotBeCheckedSaysWhy) {
  ranges_ = [](const Twist&, double) { return RangeCheck{0.0, "a wall"}; };
  const PreflightResult result = make();
  EXPECT_FALSE(result.yaw_checked);
  EXPECT_EQ(check(result, "slip").verdict, Verdict::kNotPossible);
  EXPECT_NE(check(result, "slip").why.find("a wall"), std::string::npos);
  EXPECT_EQ(base_.pose().yaw, 0.0);
  beliefs_.lost = true;
  options_.patience = 0.1;
  EXPECT_NE(check(make(), "slip").why.find("lost"), std::string::npos);
  EXPECT_EQ(base_.pose().yaw, 0.0);
}

TEST_F(PreflightRun, AStreamThatIsDeadFailsAndNothingMoves) {
  beliefs_.silent = true;
  options_.patience = 0.1;
  const PreflightResult result = make();
  EXPECT_EQ(first_failed(result.checks), "stream of cameras");
  EXPECT_EQ(base_.pose().yaw, 0.0);
  EXPECT_EQ(check(result, "slip").verdict, Verdict::kNotPossible);
}

TEST_F(PreflightRun, WhoeverHoldsOrStopsItKeepsItFromTurning) {
  DriveRequests held, stopped;
  held.hold();
  stopped.emergency_stop();
  for (DriveRequests* requests : {&held, &stopped}) {
    requests_ = requests;
    const PreflightResult result = make();
    EXPECT_FALSE(result.yaw_checked);
    EXPECT_NE(check(result, "slip").why.find("told to stand"), std::string::npos);
    EXPECT_EQ(base_.pose().yaw, 0.0);
  }
  EXPECT_TRUE(stopped.emergency_stop_waits()) << "the driver answers it";
}

TEST_F(PreflightRun, CancelledIsNotFit) {
  cancelled_ = [] { return true; };
  EXPECT_NE(first_failed(make().checks), "");
  EXPECT_EQ(base_.pose().yaw, 0.0);
}

}  // namespace
}  // namespace prospect::preflight_run_test
