// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/runtime/step_observer.h"

namespace prospect::mission_test {
namespace {

/// Moves exactly as commanded, in an open world whose map and localization a test may change.
class FakeRobot final : public LockstepRobot {
 public:
  explicit FakeRobot(std::shared_ptr<const MotionModel> model) : model_(std::move(model)) {
    belief = test::ObstacleWorld().belief();
  }
  std::shared_ptr<const Belief> sense() override {
    ++senses;
    if (on_sense) on_sense(*this);
    belief.set_stamps(clock - lag);
    return std::make_shared<const Belief>(belief);
  }
  void apply(const Twist& command, double duration) override {
    commands.push_back(command);
    durations.push_back(duration);
    if (duration > 0.0 && lost.empty()) {
      Eigen::VectorXd next(model_->nx());
      model_->step(model_->state(belief.pose, command), model_->input(command), duration, next);
      belief.pose = model_->pose(next);
      clock += duration;
    }
    belief.twist = command;
  }
  double time() const override { return clock; }
  std::string fault() const override { return lost; }
  CameraPicture picture() override { return {shows, {}}; }

  std::shared_ptr<const Image> shows;
  std::string lost;  // its time stands then
  Belief belief;
  double clock = 100.0;
  double lag = 0.0;  // age of what is sensed
  int senses = 0;
  std::function<void(FakeRobot&)> on_sense;
  std::vector<Twist> commands;
  std::vector<double> durations;

 private:
  std::shared_ptr<const MotionModel> model_;
};

/// Speeds up to `speed` and drives there, `committed` stages at a time; done after `steps` plans.
class FakeReplanner final : public Replanner {
 public:
  Plan plan(const Belief& belief) override {
    ++plans;
    if (on_plan) on_plan();
    told.push_back(belief.command);
    Plan plan;
    plan.kind = kind;
    plan.stamp = belief.stamp;
    plan.certified = true;
    plan.committed = committed;
    double v = belief.twist.linear.x();
    for (int k = 0; k < 8; ++k) {
      v = std::min(speed, v + 0.2);
      plan.inputs.push_back(Eigen::Vector2d(v, 0.0));
      plan.commands.push_back({{v, 0.0, 0.0}, 0.0});
    }
    if (kind == PlanKind::kStoppingTail) plan.certified = false;
    global_plan_ = std::make_shared<GlobalPlan>();
    if (plans > steps) plan.mode = {ModeKind::kDone, cause, belief.stamp};
    if (told_to_return) {
      plan.mode = {ModeKind::kReturn, Cause::kTaskGiven, belief.stamp};
      if (--steps_back <= 0) plan.mode = {ModeKind::kDone, cause_back, belief.stamp};
      plan.why = "back";
    }
    if (told_to_go && --steps_there <= 0) {
      plan.mode = {ModeKind::kDone, Cause::kGoalReached, belief.stamp};
      plan.why = "there";
    }
    if (plan.why.empty()) plan.why = "why";
    plan.refused = refused;
    if (plans == cut_short_at) plan.stop = StopReason::kCancelled;
    plan.heading_missed = heading_missed;
    plan.fault = fault;
    plan.detail = detail;
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return global_plan_; }
  std::string set_task(const Task& task) override {
    if (!takes_tasks) return Replanner::set_task(task);
    told_to_return = task.kind == TaskKind::kReturn;
    told_to_go = task.kind == TaskKind::kGoTo;
    return "";
  }

  std::optional<ReturnPath> return_path(const Belief&) const override {
    return return_time ? std::optional(ReturnPath{1.0, return_time()}) : std::nullopt;
  }

  std::function<double()> return_time;
  std::string refused;
  int cut_short_at = 0;  // 0: no plan is
  std::optional<double> heading_missed;
  PlanFault fault = Plan().fault;
  std::string detail;
  bool takes_tasks = true;
  bool told_to_return = false, told_to_go = false;
  int steps_there = 2;
  int steps_back = 2;
  Cause cause_back = Cause::kReturned;
  double speed = 0.2;
  int committed = 2;
  int steps = 1000000;
  Cause cause = Cause::kExplored;
  int plans = 0;
  PlanKind kind = PlanKind::kOptimised;
  std::function<void()> on_plan;
  std::vector<std::optional<Twist>> told;  // the command in force, by plan

 private:
  std::shared_ptr<GlobalPlan> global_plan_;
};

class Mission : public ::testing::Test {
 protected:
  static Certifier::Options certificate() {
    Certifier::Options options;
    options.slice = {0.1, 0.5};
    options.unknown = UnknownPolicy::kFree;
    return options;
  }
  std::shared_ptr<const MotionModel> model_ = std::make_shared<Unicycle>();
  FakeRobot robot_{model_};
  FakeReplanner planner_;
  Guard guard_{model_, CylinderShape{}, certificate()};
  MissionOptions options_;

  MissionResult run(const test::StepObserver::Function& observe,
                    const std::function<bool()>& cancelled = {},
                    DriveRequests* requests = nullptr) {
    test::StepObserver observer(observe);
    MissionOptions options = options_;
    options.observers = {&observer};
    options.cancelled = cancelled;
    return run_mission(robot_, planner_, guard_, options, requests);
  }
  void expect_stopped() {
    ASSERT_FALSE(robot_.commands.empty());
    EXPECT_EQ(robot_.commands.back().linear.norm(), 0.0);
    EXPECT_EQ(robot_.commands.back().yaw_rate, 0.0);
  }
};

TEST_F(Mission, EndsWhenNothingIsLeftToExplore) {
  planner_.steps = 3;
  std::vector<int> indices;
  const MissionResult result = run([&](const MissionStep& step) {
    indices.push_back(step.index);
    EXPECT_NE(step.plan, nullptr);
    EXPECT_NE(step.belief, nullptr);
    EXPECT_NE(step.global_plan, nullptr);
    EXPECT_NEAR(step.time, 0.5 * step.index, 1e-9);
  });
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  EXPECT_EQ(result.steps, 4);
  EXPECT_EQ(indices, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_NEAR(result.duration, 3 * 2 * 0.25, 1e-9);
  EXPECT_EQ(result.guard_stops, 0);
  EXPECT_EQ(result.fallbacks, 0);
  EXPECT_FALSE(result.detail.empty());
  EXPECT_EQ(robot_.commands.size(), 7u);  // six driven and the stop
  EXPECT_EQ(robot_.commands[5].linear.x(), 0.2);
  expect_stopped();
}

TEST_F(Mission, SaysWhyItIsDone) {
  planner_.steps = 3;
  for (const auto& [cause, end, text] :
       {std::tuple{Cause::kExplored, MissionEnd::kExplored, "explored"},
        {Cause::kYieldTooLow, MissionEnd::kYieldTooLow, "yield too low"},
        {Cause::kGoalReached, MissionEnd::kGoalReached, "goal reached"},
        {Cause::kReturned, MissionEnd::kReturned, "returned"},
        {Cause::kGoalUnreachable, MissionEnd::kGoalUnreachable, "goal unreachable"},
        {Cause::kUnreachable, MissionEnd::kUnreachable, "unreachable"}}) {
    planner_.plans = 0;
    planner_.cause = cause;
    const MissionResult result = run_mission(robot_, planner_, guard_, options_);
    EXPECT_EQ(result.end, end);
    EXPECT_EQ(to_string(result.end), text);
    EXPECT_EQ(result.detail, "why");
    EXPECT_EQ(result.steps, 4);
    expect_stopped();
  }
}

TEST_F(Mission, EndsWhenEnoughIsSeen) {
  options_.missing = [](const MissionStep& step) {
    return std::string(step.index == 2 ? "" : "1 of 2 m2");
  };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kEnough);
  EXPECT_EQ(to_string(result.end), "enough seen");
  EXPECT_EQ(result.steps, 3);
  EXPECT_TRUE(result.done());
  EXPECT_FALSE(result.back.has_value());
  expect_stopped();
}

TEST_F(Mission, WhatDoesNotFitEndsIt) {
  planner_.fault = PlanFault::kMisfit;
  planner_.detail = "the map is of another size";
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kNotFit);
  EXPECT_EQ(result.detail, planner_.detail);
  EXPECT_EQ(result.steps, 1);
}

TEST_F(Mission, ARobotThatIsLostEndsIt) {
  robot_.on_sense = [](FakeRobot& robot) {
    if (robot.clock > 102.0) robot.lost = "its server has gone";
  };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kRobotLost);
  EXPECT_EQ(result.detail, "its server has gone");
  EXPECT_FALSE(result.done());
  EXPECT_LE(robot_.clock, 103.0);
}

TEST_F(Mission, AFallEndsIt) {
  struct Fallen final : Truth {
    TrueState at(const Belief&) override { return newest(); }
    TrueState newest() const override {
      TrueState state;
      state.fallen = ++asked > 2;
      return state;
    }
    mutable int asked = 0;
  } truth;
  options_.truth = &truth;
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kFallen);
  EXPECT_EQ(row_of(result.end).outcome, Outcome::kFailed);
  EXPECT_NE(result.detail.find("no floor"), std::string::npos) << result.detail;
}

TEST_F(Mission, TellsOfCommandsAndPictures) {
  struct Watching final : MissionObserver {
    void on_command(double time, const Twist& command) override {
      times.push_back(time);
      commands.push_back(command);
    }
    void on_picture(const CameraPicture&) override { ++pictures; }
    std::vector<double> times;
    std::vector<Twist> commands;
    int pictures = 0;
  } watching;
  options_.observers = {&watching};
  planner_.steps = 3;
  robot_.shows = std::make_shared<const Image>(Image(2, 2));
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(watching.pictures, result.steps);
  ASSERT_EQ(watching.commands.size() + 1, robot_.commands.size()) << "all that take time";
  for (std::size_t n = 0; n < watching.commands.size(); ++n) {
    EXPECT_EQ(watching.commands[n].linear, robot_.commands[n].linear);
    EXPECT_NEAR(watching.times[n], 100.0 + 0.25 * static_cast<double>(n), 1e-9);
  }
}

TEST_F(Mission, ReturnsOnceItsTaskIsOver) {
  options_.return_when_done = true;
  options_.missing = [](const MissionStep& step) {
    return std::string(step.index >= 2 ? "" : "1 of 2 m2");
  };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kEnough) << "how the task ended";
  EXPECT_EQ(result.detail, "enough was seen. It is back where it began.");
  EXPECT_EQ(result.back, true);
  EXPECT_TRUE(result.done());
  EXPECT_EQ(result.steps, 5);
  expect_stopped();
}

TEST_F(Mission, ATaskThatEndsWithoutTheRobotBackIsNotDone) {
  options_.return_when_done = true;
  options_.time_limit = 10.0;
  planner_.steps = 3;
  const auto run = [&] {
    planner_.plans = 0;
    planner_.told_to_return = false;
    const MissionResult result = run_mission(robot_, planner_, guard_, options_);
    EXPECT_EQ(result.end, MissionEnd::kExplored);
    EXPECT_EQ(result.back, false);
    EXPECT_FALSE(result.done());
    EXPECT_EQ(result.detail.find("why It did not get back: "), 0u) << result.detail;
    expect_stopped();
    return result.detail;
  };
  planner_.steps_back = 2;
  planner_.cause_back = Cause::kGoalUnreachable;
  EXPECT_NE(run().find("back: back"), std::string::npos);
  planner_.steps_back = 1000;
  EXPECT_NE(run().find("time limit"), std::string::npos);
  planner_.takes_tasks = false;
  EXPECT_NE(run().find("can only explore"), std::string::npos);
  // Time that is up leaves none for the path back, and a robot that has just returned is there.
  options_.time_limit = 1.0;
  planner_.plans = 0;
  planner_.told_to_return = false;
  EXPECT_FALSE(run_mission(robot_, planner_, guard_, options_).back.has_value());
  planner_.plans = 0;
  planner_.steps = 0;
  planner_.cause = Cause::kReturned;
  const MissionResult returned = run_mission(robot_, planner_, guard_, options_);
  EXPECT_FALSE(returned.back.has_value());
  EXPECT_TRUE(returned.done());
}

// What was asked for and not seen is missing, however the planner ends.
TEST_F(Mission, LessThanWasAskedForIsNotDone) {
  options_.missing = [](const MissionStep&) { return std::string("18.0 of 60 m2"); };
  planner_.steps = 3;
  for (const auto& [cause, end] : {std::pair{Cause::kExplored, MissionEnd::kTooLittle},
                                   {Cause::kYieldTooLow, MissionEnd::kTooLittle},
                                   {Cause::kUnreachable, MissionEnd::kUnreachable},
                                   {Cause::kGoalReached, MissionEnd::kGoalReached}}) {
    planner_.plans = 0;
    planner_.cause = cause;
    const MissionResult result = run_mission(robot_, planner_, guard_, options_);
    EXPECT_EQ(result.end, end) << to_string(result.end);
    const bool done = end == MissionEnd::kGoalReached;  // what it was told is to go there
    EXPECT_EQ(result.done(), done);
    EXPECT_EQ(result.detail, done ? "why" : "why Less was seen than asked for: 18.0 of 60 m2.");
  }
  options_.time_limit = 1.0;
  planner_.plans = 0;
  const MissionResult late = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(late.end, MissionEnd::kTimeLimit);
  EXPECT_EQ(late.detail,
            "the time limit of 1 s is reached. Less was seen than asked for: 18.0 of 60 m2.");
}

TEST_F(Mission, ThatHasNotMovedSaysWhatWasRefused) {
  options_.time_limit = 2.0;
  planner_.refused = "the body would enter unknown space after 0.50 s";
  EXPECT_EQ(run_mission(robot_, planner_, guard_, options_).detail.find("moved"),
            std::string::npos);
  planner_.speed = 0.0;
  planner_.plans = 0;
  planner_.on_plan = [&] {
    if (planner_.plans == 2) planner_.refused.clear();  // the newest refusal is told
  };
  const std::string detail = run_mission(robot_, planner_, guard_, options_).detail;
  EXPECT_NE(detail.find("It has not moved: the certificate refused what it would have driven (the "
                        "body would enter unknown space after 0.50 s)."),
            std::string::npos)
      << detail;
}

// The path back is kept of the time, and no more of it than it takes.
TEST_F(Mission, TurnsBackInTime) {
  options_.return_when_done = true;
  options_.time_limit = 20.0;
  planner_.steps_back = 12;  // of 0.5 s each
  int asked = 0;
  planner_.return_time = [&] { return ++asked, 7.0; };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_LT(asked, 10) << "not at each of its steps";
  EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
  EXPECT_EQ(result.back, true) << result.detail;
  EXPECT_FALSE(result.done()) << "its task was not";
  ASSERT_TRUE(result.turned_back_at);
  // A step takes 0.5 s: after one more there would not be enough.
  EXPECT_NEAR(*result.turned_back_at, 12.5, 1e-9);
  EXPECT_LE(result.duration, 20.0);
  EXPECT_EQ(result.detail.find("turned back after 1"), 0u) << result.detail;
  EXPECT_NE(result.detail.find("about 7 s of the time limit of 20 s. It is back"),
            std::string::npos)
      << result.detail;
  // A way that grows as fast as a robot drives away is followed closely.
  planner_ = FakeReplanner();
  planner_.steps_back = 12;
  const double begun = robot_.clock;
  planner_.return_time = [&] { return 2.0 * (robot_.clock - begun); };
  const MissionResult away = run_mission(robot_, planner_, guard_, options_);
  ASSERT_TRUE(away.turned_back_at);
  EXPECT_NEAR(*away.turned_back_at, 20.0 / 3.0, 1.0);
  EXPECT_EQ(away.back, true);
  // Without a return there is nothing to keep time for.
  planner_ = FakeReplanner();
  planner_.return_time = [&] { return 7.0; };
  options_.return_when_done = false;
  const MissionResult there = run_mission(robot_, planner_, guard_, options_);
  EXPECT_NEAR(there.duration, 20.0, 1e-9);
  EXPECT_FALSE(there.turned_back_at);
}

TEST_F(Mission, TellsAHeadingThatCannotBeHad) {
  options_.return_when_done = true;
  planner_.steps = 2;
  planner_.heading_missed = 2.0;
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_TRUE(result.done());
  ASSERT_TRUE(result.heading_missed);
  EXPECT_EQ(*result.heading_missed, 2.0);
  options_.missing = [](const MissionStep&) { return std::string(); };
  options_.return_when_done = false;
  planner_.told_to_return = false;
  planner_.plans = 0;
  EXPECT_FALSE(run_mission(robot_, planner_, guard_, options_).heading_missed)
      << "of a task that ends for what was seen";
  EXPECT_EQ(result.detail, "why It is back where it began. back");
}

// The estimate of the velocity is noisy where it comes from cameras. Plans whose rates were limited
// from there broke the limit from the command in force, and the guard braked every fifth of them.
TEST_F(Mission, TellsThePlannerTheCommandInForce) {
  options_.time_limit = 4.0;
  robot_.on_sense = [](FakeRobot& r) { r.belief.twist.linear.x() = r.senses % 2 ? 0.05 : 0.4; };
  std::vector<std::size_t> applied;  // commands, before each plan
  planner_.on_plan = [&] { applied.push_back(robot_.commands.size()); };
  run_mission(robot_, planner_, guard_, options_);
  ASSERT_GE(planner_.told.size(), 6u);
  for (std::size_t n = 0; n < planner_.told.size(); ++n) {
    ASSERT_TRUE(planner_.told[n].has_value());
    if (n == 0) continue;
    const Twist& last = robot_.commands.at(applied[n] - 1);
    EXPECT_EQ(planner_.told[n]->linear, last.linear) << n;
    EXPECT_EQ(planner_.told[n]->yaw_rate, last.yaw_rate) << n;
  }
}

TEST_F(Mission, EndsAtItsTimeLimit) {
  options_.time_limit = 2.0;
  planner_.speed = 0.1;
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
  EXPECT_EQ(result.steps, 4);
  EXPECT_NEAR(result.duration, 2.0, 1e-9);
  EXPECT_EQ(result.detail, "the time limit of 2 s is reached.");
  expect_stopped();
}

TEST_F(Mission, EndsWhenLocalizationDoesNotComeBack) {
  options_.lost_limit = 3.0;
  planner_.speed = 0.0;
  robot_.on_sense = [](FakeRobot& r) {
    // Lost for two seconds, found again, then lost for good.
    const double t = r.clock - 100.0;
    const bool lost = (t > 1.0 && t < 3.0) || t > 5.0;
    r.belief.localization = lost ? Localization::kLost : Localization::kOk;
  };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kLost);
  EXPECT_GT(result.duration, 8.0);
  EXPECT_LT(result.duration, 9.1);
  expect_stopped();
}

TEST_F(Mission, DegradedIsNotLost) {
  options_.lost_limit = 0.5;
  options_.time_limit = 3.0;
  planner_.speed = 0.0;
  robot_.belief.localization = Localization::kDegraded;
  EXPECT_EQ(run_mission(robot_, planner_, guard_, options_).end, MissionEnd::kTimeLimit);
}

TEST_F(Mission, EndsWhenCancelled) {
  const MissionResult result = run({}, [&] { return planner_.plans >= 2; });
  EXPECT_EQ(result.end, MissionEnd::kCancelled);
  EXPECT_EQ(result.steps, 2);
  expect_stopped();
  // Before the first plan, too.
  FakeRobot another(model_);
  options_.cancelled = [] { return true; };
  EXPECT_EQ(run_mission(another, planner_, guard_, options_).steps, 0);
  EXPECT_EQ(another.commands.size(), 1u);
}

// Nothing can repeat a plan that was cancelled while it was made: it is no step.
TEST_F(Mission, APlanThatWasCutShortIsNoStep) {
  int observed = 0;
  planner_.cut_short_at = 3;
  const MissionResult result = run([&](const MissionStep&) { ++observed; });
  EXPECT_EQ(result.end, MissionEnd::kCancelled);
  EXPECT_EQ(planner_.plans, 3);
  EXPECT_EQ(result.steps, 2);
  EXPECT_EQ(observed, 2);
  expect_stopped();
}

TEST_F(Mission, WaitsForPeopleAndGoesOnWithItsTaskAfterADetour) {
  DriveRequests requests;
  int steps = 0, asked = 0;
  double held_at = 0.0;
  const auto person = [&] {  // asked again and again, also while it is held
    if (requests.told_to_drive() && !requests.stopped()) {
      asked = 0;
      return false;
    }
    if (++asked == 1) held_at = robot_.time();
    EXPECT_EQ(robot_.time(), held_at) << "a simulation's clock stands with it";
    if (asked < 3) return false;
    if (requests.stopped()) {
      requests.acknowledge();
    } else {
      requests.resume();
    }
    return false;
  };
  const MissionResult result = run(
      [&](const MissionStep& step) {
        ++steps;
        if (step.index == 1) requests.hold();
        if (step.index == 3) requests.emergency_stop();
        if (step.index == 5) requests.go_to({1.0, 0.0});
        if (step.index == 6) {
          EXPECT_TRUE(planner_.told_to_go);
        }
        if (step.index == 9) planner_.steps = 0;
      },
      person, &requests);
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  EXPECT_EQ(steps, result.steps);
  EXPECT_EQ(requests.told(), "there");
  EXPECT_FALSE(planner_.told_to_go) << "with its task again";
  EXPECT_FALSE(requests.stopped());
  expect_stopped();
}

// As in real time (drive_mode.h): the robot brakes first, and what is acknowledged before it stands
// is void.
TEST_F(Mission, AnEmergencyStopIsAcknowledgedAtRestOnly) {
  DriveRequests requests;
  int observed = 0;
  double stopped_at = -1.0;
  const auto person = [&] {
    if (!requests.stopped()) return false;
    if (stopped_at < 0.0) stopped_at = robot_.time();
    EXPECT_EQ(robot_.belief.twist.linear.norm(), 0.0);
    EXPECT_EQ(robot_.time(), stopped_at);
    if (++observed == 3) requests.acknowledge();
    return observed > 10;
  };
  const MissionResult result = run(
      [&](const MissionStep& step) {
        if (step.index == 3) {
          EXPECT_GT(step.belief->twist.linear.x(), 0.0);
          requests.emergency_stop();
          requests.acknowledge();
        }
        if (step.index == 4) {
          EXPECT_EQ(observed, 3) << "not before a second acknowledgement";
          EXPECT_EQ(step.belief->twist.linear.x(), 0.0) << "on from rest";
        }
        if (step.index == 6) planner_.steps = 0;
      },
      person, &requests);
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  EXPECT_EQ(observed, 3);
  expect_stopped();
}

TEST_F(Mission, AGuardStopBreaksTheCommittedPart) {
  planner_.committed = 4;
  planner_.steps = 2;
  bool wall = false;
  robot_.on_sense = [&](FakeRobot& r) {
    // After the second stage of the first plan a wall appears where it was about to drive.
    if (r.commands.size() == 2 && !wall) {
      wall = true;
      test::ObstacleWorld world;
      for (int j = -10; j < 10; ++j) world.occupy_column(3, j);
      const Belief b = world.belief();
      r.belief.voxels = b.voxels;
      r.belief.ground = b.ground;
    }
    if (r.commands.size() >= 4) {  // and is gone again
      const Belief b = test::ObstacleWorld().belief();
      r.belief.voxels = b.voxels;
      r.belief.ground = b.ground;
    }
  };
  std::vector<int> stops;
  std::vector<std::size_t> commands_before;
  const MissionResult result = run([&](const MissionStep& step) {
    stops.push_back(step.guard_stops);
    EXPECT_EQ(step.guard_reason, step.guard_stops > 0 ? GuardReason::kMap : GuardReason::kPassed);
    commands_before.push_back(robot_.commands.size());
  });
  EXPECT_EQ(result.end, MissionEnd::kExplored);
  // The first plan of four stages ended after the third command, a braking one.
  ASSERT_GE(commands_before.size(), 2u);
  EXPECT_EQ(commands_before[1], 3u);
  EXPECT_LT(robot_.commands[2].linear.x(), robot_.commands[1].linear.x());
  ASSERT_GE(stops.size(), 2u);
  EXPECT_EQ(stops[0], 0);
  EXPECT_EQ(stops[1], 1);
  EXPECT_GE(result.guard_stops, 1);
  int counted = 0;
  for (const int n : stops) counted += n;
  EXPECT_EQ(result.guard_stops, counted);
  expect_stopped();
}

TEST_F(Mission, StaleBeliefsStopTheRobotButNotTheMission) {
  options_.time_limit = 3.0;
  robot_.on_sense = [](FakeRobot& r) { r.lag = r.clock > 101.0 ? 2.0 : 0.0; };
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
  EXPECT_GT(result.guard_stops, 3);
  EXPECT_EQ(robot_.commands[robot_.commands.size() - 2].linear.x(), 0.0);
}

TEST_F(Mission, CountsFallbacks) {
  planner_.kind = PlanKind::kStoppingTail;
  planner_.speed = 0.0;
  options_.time_limit = 2.0;
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.fallbacks, result.steps);
  EXPECT_EQ(result.guard_stops, 0);
}

TEST_F(Mission, AThrowingObserverStopsTheRobotFirst) {
  EXPECT_THROW(run([](const MissionStep& step) {
                 if (step.index == 2) throw std::runtime_error("disk full");
               }),
               std::runtime_error);
  EXPECT_EQ(robot_.commands.size(), 5u);
  EXPECT_GT(robot_.commands[3].linear.x(), 0.0);
  expect_stopped();
}

// The last command was a zero past the guard: no base stops from 0.5 m/s at once.
TEST_F(Mission, ComesToRestWithinTheRates) {
  planner_.speed = 0.5;
  const auto expect_braked = [&](const FakeRobot& robot, std::size_t driven) {
    ASSERT_EQ(robot.commands.size(), driven + 3);
    const double speeds[] = {0.5, 0.3, 0.1, 0.0};
    for (std::size_t n = 0; n < 4; ++n) {
      EXPECT_NEAR(robot.commands[driven - 1 + n].linear.x(), speeds[n], 1e-12);
    }
    EXPECT_EQ(robot.commands.back().linear.norm(), 0.0);
    EXPECT_EQ(robot.durations[driven], 0.25);
    EXPECT_EQ(robot.durations.back(), 0.0);
  };
  options_.time_limit = 2.0;
  const MissionResult result = run_mission(robot_, planner_, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
  EXPECT_NEAR(result.duration, 2.0, 1e-9) << "the last stop does not count";
  EXPECT_EQ(result.guard_stops, 0);
  expect_braked(robot_, 8);

  for (const bool standard : {true, false}) {
    FakeRobot robot(model_);
    FakeReplanner planner;
    planner.speed = 0.5;
    const auto fail = [&](const MissionStep& step) {
      if (step.index < 3) return;
      if (standard) throw std::runtime_error("disk full");
      throw 7;
    };
    test::StepObserver observer(fail);
    MissionOptions options = options_;
    options.observers = {&observer};
    EXPECT_ANY_THROW(run_mission(robot, planner, guard_, options));
    expect_braked(robot, 6);
  }

  // With sources that have died, too, and from a wall ahead.
  FakeRobot robot(model_);
  planner_.plans = 0;
  planner_.steps = 4;
  robot.on_sense = [&](FakeRobot& r) { r.lag = planner_.plans > 4 ? 50.0 : 0.0; };
  EXPECT_EQ(run_mission(robot, planner_, guard_, options_).end, MissionEnd::kTimeLimit);
  expect_braked(robot, 8);
}

TEST_F(Mission, ABaseThatCannotStopDoesNotHoldTheMission) {
  const auto model = std::make_shared<Unicycle>(Unicycle::Parameters{.a_max = 1e-4});
  const Guard guard(model, CylinderShape{}, certificate());
  robot_.belief.twist.linear.x() = 0.4;
  options_.cancelled = [] { return true; };
  run_mission(robot_, planner_, guard, options_);
  EXPECT_EQ(robot_.commands.size(), 100u);
}

TEST_F(Mission, BrokenPlansAreStops) {
  // Empty, of no duration, and without a number: a mission must neither crash nor hang.
  class Broken final : public Replanner {
   public:
    Plan plan(const Belief& belief) override {
      Plan plan;
      plan.stamp = belief.stamp;
      switch (++plans_ % 3) {
        case 0:
          break;
        case 1:
          plan.dt = 0.0;
          break;
        case 2:
          plan.dt = std::numeric_limits<double>::quiet_NaN();
          plan.commands.resize(3);
          plan.committed = 3;
          break;
      }
      return plan;
    }
    std::shared_ptr<const GlobalPlan> global_plan() const override { return nullptr; }

   private:
    int plans_ = 0;
  } broken;
  options_.time_limit = 3.0;
  robot_.belief.twist.linear.x() = 0.4;
  const MissionResult result = run_mission(robot_, broken, guard_, options_);
  EXPECT_EQ(result.end, MissionEnd::kTimeLimit);
  EXPECT_EQ(result.guard_stops, result.steps);
  for (std::size_t n = 0; n + 1 < robot_.durations.size(); ++n) {
    EXPECT_GT(robot_.durations[n], 0.0);
    EXPECT_LE(robot_.commands[n].linear.norm(), 0.4);
  }
  expect_stopped();
}

}  // namespace
}  // namespace prospect::mission_test
