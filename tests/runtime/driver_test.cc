// SPDX-License-Identifier: Apache-2.0
#include "runtime/driver.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/runtime/fake_base.h"
#include "tests/runtime/patient_guard.h"
#include "tests/runtime/step_observer.h"

namespace prospect::driver_test {
namespace {

constexpr double kSpeed = 0.3;  // [m/s]

/// Knows exactly where the base is, in an open world.
class TrueBeliefs final : public BeliefSource {
 public:
  TrueBeliefs(const Clock& clock, test::FakeBase& base) : clock_(clock), base_(base) {}
  std::shared_ptr<const Belief> update(const std::stop_token& stop) override {
    clock_.wait_until(clock_.now() + 0.01, stop);
    if (silent) return nullptr;
    auto belief = std::make_shared<Belief>(world_);
    belief->set_stamps(clock_.now());
    belief->pose = base_.pose();
    belief->twist = base_.velocity();
    return belief;
  }
  std::atomic<bool> silent{false};

 private:
  const Clock& clock_;
  test::FakeBase& base_;
  const Belief world_ = test::ObstacleWorld().belief();
};

/// Drives on straight ahead, from whatever velocity it is given; done after `steps` plans.
class StraightOn final : public Replanner {
 public:
  void prepare(const Belief&) override {
    ++prepared;
    if (on_prepare) on_prepare(prepared);
  }
  Plan plan(const Belief& belief) override {
    ++plans;
    EXPECT_EQ(prepared, plans);
    if (on_plan) on_plan(plans);
    const Unicycle model;
    Plan plan;
    plan.kind = PlanKind::kOptimised;
    plan.stamp = belief.stamp;
    plan.certified = true;
    plan.committed = 2;
    double v = belief.command->linear.x();
    for (int k = 0; k < 4; ++k) {
      v = std::min(kSpeed, v + 0.2);
      plan.inputs.push_back(Eigen::Vector2d(v, 0.0));
      plan.commands.push_back({{v, 0.0, 0.0}, 0.0});
    }
    for (double u = plan.commands[1].linear.x(); u > 0.0;) {
      u = std::max(0.0, u - 0.2);
      plan.tail.push_back({{u, 0.0, 0.0}, 0.0});
    }
    if (plans > steps) plan.mode = {ModeKind::kDone, Cause::kExplored, belief.stamp};
    if (task == TaskKind::kGoTo && --plans_to_goal <= 0) {
      plan.mode = {ModeKind::kDone, Cause::kGoalReached, belief.stamp};
      plan.why = "It is there.";
    }
    starts.push_back(belief.stamp);
    predicted.push_back(belief.pose);
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return nullptr; }

  std::string set_task(const Task& told) override {
    if (told.kind == TaskKind::kGoTo && told.goal.position.x() < 0.0) return "in a keep-out";
    task = told.kind;
    return "";
  }

  int plans = 0, prepared = 0;
  int steps = 1000;
  std::atomic<TaskKind> task = TaskKind::kExplore;
  int plans_to_goal = 3;
  std::function<void(int)> on_prepare, on_plan;
  std::vector<double> starts;
  std::vector<Pose> predicted;
};

class DriverTest : public ::testing::Test {
 protected:
  DriverTest() {
    options_.command.period = 0.02;
    options_.command.hold = 0.1;
    options_.mode.live_time = options_.mode.rest_time = 0.05;
    options_.replan_period = 0.1;
    // Tests share their machine.
    options_.least_latency = 0.05;
    options_.command_limit = 5.0;
    options_.perception_limit = 5.0;
    options_.planner_limit = 5.0;
  }
  DriverParts parts() {
    return {.clock = clock_, .guard = guard_, .model = model_, .dead_man = base_.dead_man()};
  }
  /// Observers are asked for on_step alone.
  Driver make(const DriverParts& parts, const test::StepObserver::Function& observe = {},
              const MissionOptions& given = {}) {
    observer_.emplace(observe);
    MissionOptions mission = given;
    mission.observers = {&*observer_};
    return Driver(parts, planner_, PreflightResult{.checks = {}, .yaw_checked = true}, options_,
                  mission);
  }
  Driver make() { return make(parts()); }
  /// The fastest command sent in that time.
  double fastest(double from, double until) const {
    double speed = 0.0;
    for (const auto& [time, command] : base_.sent()) {
      if (time >= from && time < until) speed = std::max(speed, command.linear.x());
    }
    return speed;
  }

  SteadyClock clock_;
  test::FakeBase base_{clock_};
  TrueBeliefs beliefs_{clock_, base_};
  StraightOn planner_;
  std::shared_ptr<const Unicycle> model_ = std::make_shared<const Unicycle>();
  Guard guard_ = test::patient_guard(model_);
  DriverOptions options_;
  std::optional<test::StepObserver> observer_;
};

TEST_F(DriverTest, DrivesUntilTheTaskIsOverAndStands) {
  planner_.steps = 8;
  DriverParts robot = parts();
  robot.streams = {{"truth", 0.5, [](const Belief* newest) {
                      return newest ? std::optional(newest->stamps.pose) : std::nullopt;
                    }}};
  int observed = 0;
  Driver driver = make(robot, [&](const MissionStep& step) {
    EXPECT_EQ(step.index, observed++);
    EXPECT_GE(step.plan->stamp, step.belief->stamp);
  });
  const MissionResult result = driver.run(base_, beliefs_);
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  EXPECT_EQ(result.steps, 9);
  EXPECT_EQ(observed, 9);
  EXPECT_GT(base_.pose().position.x(), 0.01);
  EXPECT_EQ(base_.velocity().linear.norm(), 0.0);
  EXPECT_GE(base_.stops(), 1);
  const DriverStatus status = driver.status();
  EXPECT_GT(status.capture_to_command.count(), 10u);
  EXPECT_EQ(status.planning.count(), 9u);
  // Each plan begins where the robot then is: the predictions follow each other.
  for (std::size_t k = 1; k < planner_.predicted.size(); ++k) {
    const double way = planner_.predicted[k].position.x() - planner_.predicted[k - 1].position.x();
    EXPECT_LE(way, kSpeed * (planner_.starts[k] - planner_.starts[k - 1]) + 0.02);
    EXPECT_GE(way, -1e-9);
  }

  const HealthReport health = driver.health();
  EXPECT_EQ(health.threads.size(), 3u);
  EXPECT_EQ(health.drive.mode, driver.status().mode.mode);
  ASSERT_EQ(health.sources.size(), 1u);
  EXPECT_EQ(health.sources[0].name, "truth");
  EXPECT_LT(health.sources[0].age, 60.0);
  EXPECT_GT(health.latencies.at(0).histogram.count(), 0u);
}

TEST_F(DriverTest, APlannerThatHangsLeavesTheRobotOnTheStopOfItsPlan) {
  double hung = 0.0, back = 0.0;
  planner_.steps = 7;
  planner_.on_plan = [&](int plan) {
    if (plan != 6) return;
    hung = clock_.now();
    clock_.wait_until(hung + 1.2, {});
    back = clock_.now();
  };
  Driver driver = make();
  const MissionResult result = driver.run(base_, beliefs_);
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  // The plan before commits 0.5 s, and the stop from 0.3 m/s takes 0.4 s.
  const double end = planner_.starts[4] + 0.5 + 0.4 + 0.06;
  ASSERT_LT(end, back);
  EXPECT_GT(fastest(hung, end), 0.0);
  EXPECT_EQ(fastest(end, back), 0.0);
}

TEST_F(DriverTest, AnEmergencyStopLatchesUntilItIsAcknowledged) {
  Driver driver = make();
  double pressed = 0.0, released = 0.0;
  std::jthread person([&] {
    const auto wait_for = [&](const std::function<bool()>& so) {
      const double end = clock_.now() + 10.0;
      while (!so() && clock_.now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      EXPECT_TRUE(so());
    };
    wait_for([&] { return base_.velocity().linear.x() > 0.1; });
    pressed = clock_.now();
    driver.requests().emergency_stop();
    driver.requests().acknowledge();  // void: it moves
    wait_for([&] { return driver.status().mode.mode == DriveMode::kStopped; });
    EXPECT_EQ(base_.velocity().linear.norm(), 0.0);
    // It is held: a base that does not follow might make something else of a velocity of zero.
    const auto pass = [&](double periods) {
      clock_.wait_until(clock_.now() + periods * options_.command.period, {});
    };
    pass(2.0);
    const std::size_t told = base_.sent().size();
    const int held = base_.stops();
    pass(4.0);
    EXPECT_EQ(base_.sent().size(), told);
    EXPECT_GT(base_.stops(), held);
    EXPECT_EQ(driver.status().mode.mode, DriveMode::kStopped);
    released = clock_.now();
    driver.requests().acknowledge();
    wait_for([&] { return base_.velocity().linear.x() > 0.1; });
    driver.stop();
  });
  const MissionResult result = driver.run(base_, beliefs_);
  EXPECT_EQ(result.end, MissionEnd::kCancelled);
  EXPECT_EQ(base_.velocity().linear.norm(), 0.0);
  // The command that is under way may still come; none after it.
  EXPECT_EQ(fastest(pressed + 3.0 * options_.command.period, released), 0.0);
  bool told = false;
  for (const Event& event : driver.events().since(0).events) {
    told = told || (event.source == "drive mode" && event.cause == "emergency stop");
  }
  EXPECT_TRUE(told);
}

TEST_F(DriverTest, AnEmergencyStopThatNobodyCouldPressKeepsItStandingAndStopsIt) {
  EmergencyStopInput button("/stop", {.max_age = 0.3});
  DriverParts robot = parts();
  robot.emergency_stop = &button;
  Driver driver = make(robot);
  std::atomic<bool> lives = false;
  std::jthread publisher([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (lives) button.told(1, false, clock_.now());
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  std::jthread person([&] {
    const auto wait_for = [&](const char* what, const std::function<bool()>& so) {
      const double end = clock_.now() + 20.0;
      while (!so() && clock_.now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      EXPECT_TRUE(so()) << what << ": " << driver.status().why;
    };
    const auto is = [&](DriveMode mode, DriveCause cause) {
      const DriveState state = driver.status().mode;
      return state.mode == mode && state.cause == cause;
    };
    wait_for("absent", [&] { return is(DriveMode::kIdle, DriveCause::kEmergencyStopSilent); });
    EXPECT_EQ(base_.pose().position.x(), 0.0);
    lives = true;
    wait_for("late", [&] { return base_.velocity().linear.x() > 0.1; });
    lives = false;
    wait_for("died", [&] {
      return is(DriveMode::kStopping, DriveCause::kEmergencyStopSilent) &&
             base_.velocity().linear.norm() == 0.0;
    });
    driver.requests().acknowledge();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(is(DriveMode::kStopping, DriveCause::kEmergencyStopSilent)) << "still nobody";
    lives = true;
    wait_for("there again",
             [&] { return is(DriveMode::kStopped, DriveCause::kEmergencyStopSilent); });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(is(DriveMode::kStopped, DriveCause::kEmergencyStopSilent)) << "not by itself";
    driver.requests().acknowledge();
    wait_for("acknowledged", [&] { return base_.velocity().linear.x() > 0.1; });
    driver.stop();
  });
  EXPECT_EQ(driver.run(base_, beliefs_).end, MissionEnd::kCancelled);
  bool named = false;
  for (const Event& event : driver.events().since(0).events) {
    named = named || (event.cause == "emergency stop silent" &&
                      event.text.find("/stop: 0 of 1 publishers") != std::string::npos);
  }
  EXPECT_TRUE(named);
}

TEST_F(DriverTest, PeopleHoldStopAndSendItByRequestsOfTheirOwn) {
  DriveRequests requests;
  DriverParts robot = parts();
  robot.requests = &requests;
  Driver driver = make(robot);
  // The speed that is sent is lower from the second command after a time on: that under way was
  // decided before. It is the only one where a busy machine is late and the base stood by then.
  const auto expect_slower_after = [&](double pressed) {
    std::vector<double> after;
    for (const auto& [time, command] : base_.sent()) {
      if (time > pressed) after.push_back(command.linear.x());
    }
    for (std::size_t k = 1; k < after.size(); ++k) {
      EXPECT_LT(after[k], kSpeed);
      EXPECT_LE(after[k], after[k - 1]);
    }
  };
  std::jthread person([&] {
    const auto wait_for = [&](const char* what, const std::function<bool()>& so) {
      const double end = clock_.now() + 20.0;
      while (!so() && clock_.now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      EXPECT_TRUE(so()) << what;
    };
    const auto at_full_speed = [&] { return base_.velocity().linear.x() > 0.99 * kSpeed; };
    const auto stands = [&] { return base_.velocity().linear.norm() == 0.0; };
    const auto is = [&](DriveMode mode) { return driver.status().mode.mode == mode; };
    wait_for("full speed", at_full_speed);
    double pressed = clock_.now();
    requests.hold();
    wait_for("held", [&] { return stands() && is(DriveMode::kReady); });
    expect_slower_after(pressed);
    requests.resume();
    wait_for("resumed", at_full_speed);

    requests.go_to({1.0, 0.0});
    wait_for("sent", [&] { return planner_.task == TaskKind::kGoTo; });
    wait_for("there, and with its task again",
             [&] { return planner_.task == TaskKind::kExplore && !requests.told_to_drive(); });
    EXPECT_EQ(requests.told(), "It is there.");
    wait_for("held there", stands);
    requests.go_to({-1.0, 0.0});
    wait_for("refused", [&] { return requests.told() == "in a keep-out"; });
    EXPECT_FALSE(requests.told_to_drive()) << "what is refused starts nothing";
    requests.resume();
    wait_for("full speed again", at_full_speed);

    pressed = clock_.now();
    requests.emergency_stop();
    wait_for("stopped", [&] { return requests.stopped(); });
    expect_slower_after(pressed);
    driver.stop();
  });
  EXPECT_EQ(driver.run(base_, beliefs_).end, MissionEnd::kCancelled);
}

// Nothing but the five calls, by loops of one's own.
TEST_F(DriverTest, FiveCallsAreAWholeRobot) {
  planner_.steps = 4;
  Driver driver = make();
  std::jthread perceives([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) driver.observe(beliefs_.update(stop));
  });
  std::jthread plans([&](const std::stop_token& stop) {
    while (driver.advance(stop)) {
    }
  });
  bool drove = false;
  for (const double end = clock_.now() + 20.0; !driver.at_rest() && clock_.now() < end;) {
    const CommandStep step = driver.command(base_.report());
    drove = drove || step.reason == CommandReason::kPlan;
    base_.send(step.command, step.expires);
    clock_.wait_until(clock_.now() + options_.command.period, {});
  }
  plans.join();
  EXPECT_TRUE(drove);
  EXPECT_TRUE(driver.at_rest());
  EXPECT_FALSE(driver.advance());
  EXPECT_EQ(driver.finish().end, MissionEnd::kExplored);
  EXPECT_FALSE(driver.events().since(0).events.empty());
}

/// What is waited for comes at once.
class LeapingClock final : public Clock {
 public:
  double now() const noexcept override { return now_; }
  bool wait_until(double time, const std::stop_token&) const noexcept override {
    now_ = std::max(now_, time);
    return true;
  }
  void take(double seconds) const { now_ += seconds; }

 private:
  mutable double now_ = 100.0;
};

// A plan is prepared and made as long before its start as that has taken so far, so that it is
// there in time and rests on the newest belief, and one comes each period.
TEST_F(DriverTest, PlansAreMadeJustBeforeTheyBegin) {
  const LeapingClock clock;
  options_.replan_period = 0.4;
  constexpr double kPreparing = 0.06, kPlanning = 0.08;  // [s], at most
  std::vector<double> prepared, begun;
  planner_.on_prepare = [&](int n) {
    prepared.push_back(clock.now());
    clock.take(n % 3 == 1 ? kPreparing : 0.2 * kPreparing);
  };
  planner_.on_plan = [&](int n) {
    begun.push_back(clock.now());
    clock.take(n % 3 == 1 ? kPlanning : 0.2 * kPlanning);
  };
  DriverParts robot{.clock = clock, .guard = guard_, .model = model_, .dead_man = 0.5};
  Driver driver = make(robot);
  double before = clock.now();
  EXPECT_TRUE(driver.advance()) << "nothing is known so far";
  EXPECT_GT(clock.now(), before) << "it waits";
  for (int n = 0; n < 12; ++n) {
    auto belief = std::make_shared<Belief>(test::ObstacleWorld().belief());
    belief->set_stamps(clock.now());
    belief->localization = Localization::kOk;
    driver.observe(belief);
    EXPECT_TRUE(driver.advance());
  }
  ASSERT_EQ(planner_.starts.size(), 12u);
  for (std::size_t k = 2; k < planner_.starts.size(); ++k) {
    const double start = planner_.starts[k];
    EXPECT_NEAR(start - planner_.starts[k - 1], options_.replan_period, 1e-9);
    EXPECT_LE(begun[k] + kPlanning, start);
    EXPECT_LE(prepared[k] + kPreparing, begun[k] + 1e-9);
    EXPECT_GT(begun[k] + kPlanning + 0.1, start) << "not on an older belief than needed";
    EXPECT_GT(prepared[k] + kPreparing + 0.1, begun[k]);
  }
}

// Its pose is that of its wheels, which say that it drives straight on.
TEST_F(DriverTest, AGyroNamesABaseThatTurnsAndAnImuThatFallsSilentStopsIt) {
  for (const bool silent : {false, true}) {
    SensorInbox inbox(clock_, in_runtime_clock(SensorInboxOptions()));
    DriverParts robot = parts();
    robot.inbox = &inbox;
    robot.pose_of_wheels = true;
    robot.streams = {watched(inbox, SensorStream::kImu, "imu", 0.3)};
    options_.mode.live_time = 0.8;
    StraightOn planner;
    test::FakeBase base(clock_);
    TrueBeliefs beliefs(clock_, base);
    MissionOptions mission;
    mission.time_limit = 4.0;
    Driver driver(robot, planner, PreflightResult{.checks = {}, .yaw_checked = true}, options_,
                  mission);
    const std::jthread measures([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        clock_.wait_until(clock_.now() + 0.01, stop);
        const bool drives = base.velocity().linear.x() > 0.1;
        ImuSample sample;
        sample.stamp = clock_.now();
        sample.angular_velocity.z() = 0.02 + (drives ? 0.8 : 0.0);
        sample.linear_acceleration.x() = 1e-3 * std::sin(1e3 * sample.stamp);
        if (!(silent && drives)) inbox.observe(sample);
      }
    });
    driver.run(base, beliefs);
    bool named = false;
    for (const Event& event : driver.events().since(0).events) {
      named = named || (event.cause == (silent ? "source stale" : "does not follow") &&
                        event.text.find(silent ? "imu" : "by gyro") != std::string::npos);
    }
    EXPECT_TRUE(named) << silent;
  }
}

TEST_F(DriverTest, StopEndsAMissionThatNothingIsKnownOf) {
  Driver driver = make();
  EXPECT_TRUE(driver.advance());
  driver.stop();
  EXPECT_FALSE(driver.advance());
  EXPECT_EQ(driver.finish().end, MissionEnd::kCancelled);
}

TEST_F(DriverTest, WhatAnObserverThrowsComesAfterTheRobotStands) {
  int observed = 0;
  Driver driver = make(parts(), [&](const MissionStep&) {
    if (++observed == 5) throw std::runtime_error("full disk");
  });
  EXPECT_THROW(driver.run(base_, beliefs_), std::runtime_error);
  EXPECT_EQ(base_.velocity().linear.norm(), 0.0);
}

TEST_F(DriverTest, ABaseWithoutADeadManIsRefused) {
  DriverParts without = parts();
  without.dead_man.reset();
  try {
    make(without);
    FAIL() << "was taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("the base declares no dead-man"), std::string::npos);
  }
}

TEST_F(DriverTest, WithoutPreflightOrWithACheckThatFailedItStands) {
  MissionOptions mission;
  mission.time_limit = 0.3;
  for (const auto& checks :
       {std::optional<PreflightResult>(),
        std::optional(PreflightResult{{{"floor", CheckVerdict::kFailed, "0.1 m"}}, true})}) {
    StraightOn planner;
    Driver driver(parts(), planner, checks, options_, mission);
    const MissionResult result = driver.run(base_, beliefs_);
    EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
    EXPECT_EQ(base_.pose().position.x(), 0.0);
    EXPECT_EQ(driver.status().mode.cause, DriveCause::kPreflight);
    EXPECT_EQ(driver.health().preflight.size(), checks ? 1u : 0u);
  }
}

}  // namespace
}  // namespace prospect::driver_test
