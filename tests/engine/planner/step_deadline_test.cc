// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/features/unseen_features.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/map_projection.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_fit.h"
#include "engine/planner/step_landmarks.h"
#include "engine/support/resumable.h"
#include "engine/support/stopwatch.h"
#include "models/make_model.h"
#include "tests/engine/known_rooms.h"
#include "tests/engine/longest_piece.h"
#include "tests/engine/planning_scene.h"

namespace prospect::step_deadline_test {
namespace {

/// What a step may take where `asked` seconds are asked for [s].
double allowed(double asked) { return 1.5 * asked + 0.002; }

using test::give_rooms;
using test::landmarks_about;
using test::longest_piece;

/// A robot that drives as it is told.
class StepDeadline : public ::testing::Test {
 protected:
  Belief belief_;
  std::unique_ptr<Planner> planner_;
  std::vector<Plan> plans_;
  std::vector<double> times_;  // [s]

  void SetUp() override {
    belief_.octree = std::make_shared<const octomap::OcTree>(0.1);
    belief_.landmarks = landmarks_about(300);
    belief_.command = Twist();
    belief_.tracked_features = 80;
  }
  void begin(double deadline, const char* model = "unicycle", PlannerParameters parameters = {}) {
    RobotDescription robot;
    robot.model = make_model(model);
    parameters.deadline = deadline;
    planner_ = std::make_unique<Planner>(robot, parameters, std::make_shared<test::IdleSolver>());
  }
  const Plan& step() {
    belief_.set_stamps(0.25 * static_cast<double>(plans_.size()));
    ProcessorStopwatch watch(CLOCK_PROCESS_CPUTIME_ID);  // the machine may be busy
    plans_.push_back(planner_->plan(belief_));
    times_.push_back(1e-3 * watch.lap());
    const Plan& plan = plans_.back();
    const MotionModel& model = *planner_->robot().model;
    Eigen::VectorXd next(model.nx());
    model.step(model.state(belief_.pose, belief_.twist), model.input(plan.commands.front()), 0.25,
               next);
    belief_.pose = model.pose(next);
    belief_.twist = plan.commands.front();
    belief_.command = belief_.twist;
    return plan;
  }
  /// Steps until one is made whole, `most` at most; until then the robot stands and is told why.
  void begin_to_drive(int most) {
    while (step().fault == PlanFault::kUnfinished) {
      ASSERT_GT(--most, 0) << "it never ends";
      EXPECT_EQ(plans_.back().kind, PlanKind::kStoppingTail);
      EXPECT_NE(plans_.back().detail.find("deadline"), std::string::npos);
      EXPECT_EQ(belief_.twist.linear.norm(), 0.0);
      EXPECT_FALSE(planner_->step()->made());
    }
    EXPECT_EQ(plans_.back().fault, PlanFault::kNone) << plans_.back().detail;
  }
  /// Whatever is older than the plan, its sentence says so.
  static void expect_ages_told(const Plan& plan) {
    struct Part {
      const char* name;
      double age;
    };
    for (const Part& part : {Part{"the target of", plan.age.global_plan},
                             {"the landmarks of", plan.age.landmarks},
                             {"the distances to obstacles of", plan.age.clearance}}) {
      EXPECT_GE(part.age, 0.0);
      EXPECT_LE(part.age, plan.stamp);
      EXPECT_EQ(plan.why.find(part.name) != std::string::npos, part.age > 0.0) << plan.why;
    }
  }
  /// But for one step in twenty, which the machine may have disturbed.
  void expect_in_time(double deadline) {
    std::vector<double> sorted = times_;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_LE(sorted[sorted.size() - 1 - sorted.size() / 20], allowed(deadline));
  }
};

// The first plan took 0.5 s in 100 m, and each one as long after which the map had moved.
TEST_F(StepDeadline, OfALargeMapThatMovesEachTime) {
  constexpr double kDeadline = 0.02;
  begin(kDeadline);
  give_rooms(belief_, 60.0);
  begin_to_drive(1000);
  for (int n = 1; n < 10; ++n) {
    give_rooms(belief_, 60.0, n % 3);
    const Plan& plan = step();
    EXPECT_EQ(plan.fault, PlanFault::kNone) << plan.detail;
    expect_ages_told(plan);
  }
  expect_in_time(kDeadline);
}

TEST_F(StepDeadline, OfManyLandmarks) {
  constexpr double kDeadline = 0.02;
  begin(kDeadline);
  give_rooms(belief_, 20.0);
  belief_.landmarks = landmarks_about(200'000);
  begin_to_drive(1000);
  for (int n = 0; n < 10; ++n) EXPECT_EQ(step().fault, PlanFault::kNone);
  EXPECT_FALSE(planner_->step()->landmarks.empty());
  expect_in_time(kDeadline);
}

TEST_F(StepDeadline, OfFiveMilliseconds) {
  constexpr double kDeadline = 0.005;
  begin(kDeadline);
  give_rooms(belief_, 20.0);
  begin_to_drive(1000);
  for (int n = 0; n < 60; ++n) EXPECT_EQ(step().fault, PlanFault::kNone);
  expect_in_time(kDeadline);
  EXPECT_GT(belief_.pose.position.norm(), 0.5) << "it drives all the same";
}

// In 3-D the distances to obstacles, the lines of sight and the first seeds took longer, each
// alone, than steps may.
TEST_F(StepDeadline, OfABaseThatMovesInSpace) {
  constexpr double kDeadline = 0.02;
  begin(kDeadline, "multirotor");
  give_rooms(belief_, 12.0);
  belief_.pose.position.z() = 0.3;
  begin_to_drive(1000);
  EXPECT_TRUE(planner_->step()->made());
  for (int n = 1; n < 20; ++n) {
    give_rooms(belief_, 12.0, n % 3);
    const Plan& plan = step();
    EXPECT_EQ(plan.fault, PlanFault::kNone) << plan.detail;
    EXPECT_GE(plan.seeds_scored, 1);
    expect_ages_told(plan);
  }
  expect_in_time(kDeadline);
}

// To find the spheres that cover such a hull took 0.26 s of the first step.
TEST_F(StepDeadline, OfABodyOfManyCorners) {
  constexpr double kDeadline = 0.01;
  constexpr int kCorners = 500;
  ConvexShape hull;
  for (int n = 0; n < kCorners; ++n) {
    const double z = -1.0 + (2.0 * n + 1.0) / kCorners, across = std::sqrt(1.0 - z * z);
    hull.vertices.emplace_back(0.3 * across * std::cos(2.4 * n), 0.2 * across * std::sin(2.4 * n),
                               0.1 * z);
  }
  RobotDescription robot;
  robot.model = make_model("multirotor");
  robot.shape = hull;
  PlannerParameters parameters;
  parameters.deadline = kDeadline;
  planner_ = std::make_unique<Planner>(robot, parameters, std::make_shared<test::IdleSolver>());
  give_rooms(belief_, 8.0);
  belief_.pose.position.z() = 0.3;
  for (int n = 0; n < 30; ++n) EXPECT_NE(step().fault, PlanFault::kError) << plans_.back().detail;
  EXPECT_EQ(plans_.back().fault, PlanFault::kNone) << plans_.back().detail;
  expect_in_time(kDeadline);
  EXPECT_LT(*std::max_element(times_.begin(), times_.end()), 0.1);
}

// A robot that drives has time between two steps.
TEST_F(StepDeadline, WhatIsUnfinishedIsGoneOnWithBetweenSteps) {
  begin(0.001);
  give_rooms(belief_, 30.0);
  const auto finish = [&] {
    while (planner_->go_on(0.001)) {
    }
  };
  for (int n = 0; n < 3 && step().fault == PlanFault::kUnfinished; ++n) finish();
  for (int n = 0; n < 3; ++n) {
    finish();
    EXPECT_EQ(step().fault, PlanFault::kNone) << plans_.back().detail;
    // Of the step before, whose belief it was begun with.
    EXPECT_LE(plans_.back().age.global_plan, 0.5);
    EXPECT_LE(plans_.back().age.landmarks, 0.5);
    EXPECT_LE(plans_.back().age.clearance, 0.5);
  }
  planner_->prepare(belief_);
  finish();
  EXPECT_FALSE(planner_->go_on(0.001));
  const double prepared = belief_.stamp;
  step();
  EXPECT_EQ(plans_.back().age.global_plan, plans_.back().stamp - prepared);
  EXPECT_EQ(plans_.back().why.find("the target of"), std::string::npos) << plans_.back().why;
}

/// A quarter of the cells free, at random, the others unknown: frontiers everywhere.
void give_speckle(Belief& belief, double side) {
  const int n = static_cast<int>(std::lround(10.0 * side));
  auto voxels = std::make_shared<VoxelGrid>(GridFrame{0.1, -10, -10, n, n}, 0.0, 0.6);
  std::uint32_t random = 7;
  for (int j = -10; j < n - 10; ++j) {
    for (int i = -10; i < n - 10; ++i) {
      random = random * 1664525U + 1013904223U;
      if (random >> 30U == 0 && std::hypot(i, j) > 8.0) continue;
      for (int k = 0; k < 6; ++k) voxels->set(i, j, k, CellState::kFree);
    }
  }
  belief.ground = std::make_shared<const GroundMap>(project(*voxels, {0.1, 0.5}, 16));
  belief.voxels = std::move(voxels);
}

// Maps, landmarks and deadlines as a hostile caller brings them, from the first step on.
TEST_F(StepDeadline, OfHostileMaps) {
  struct Row {
    const char* what;
    double deadline;  // [s]
    const char* model;
    std::function<void(Belief&)> change;
  };
  const Row rows[] = {
      {"speckle", 0.005, "unicycle", [](Belief& b) { give_speckle(b, 40.0); }},
      {"speckle, more time", 0.05, "unicycle_accel", [](Belief& b) { give_speckle(b, 20.0); }},
      {"rooms", 0.01, "holonomic", [](Belief& b) { give_rooms(b, 60.0); }},
      {"rooms in 3-D", 0.01, "multirotor", [](Belief& b) { give_rooms(b, 20.0); }},
      {"few features: a retreat", 0.01, "unicycle", [](Belief& b) { b.tracked_features = 3; }},
      {"landmarks of one place", 0.01, "unicycle",
       [](Belief& b) {
         auto map = std::make_shared<LandmarkMap>(*landmarks_about(50'000));
         for (Landmark& l : map->landmarks) l.position = {1.0, 1.0, 0.5}, l.id = 7;
         b.landmarks = std::move(map);
       }},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.what);
    plans_.clear();
    times_.clear();
    belief_ = {};
    SetUp();
    give_rooms(belief_, 20.0);
    row.change(belief_);
    begin(row.deadline, row.model);
    if (row.model == std::string("multirotor")) belief_.pose.position.z() = 0.3;
    for (int n = 0; n < 20; ++n) EXPECT_NE(step().fault, PlanFault::kError) << plans_.back().detail;
    expect_in_time(row.deadline);
  }
}

// Of 4 times as many looks each evaluation takes longer than all of the step may.
TEST_F(StepDeadline, OfTheLargestProblemThatIsAllowed) {
  constexpr double kDeadline = 0.05;
  PlannerParameters parameters;
  parameters.N = 250;
  parameters.max_landmarks = static_cast<int>(kMostViewsPerSecond * kDeadline) / parameters.N;
  begin(kDeadline, "unicycle", parameters);
  give_rooms(belief_, 30.0);
  belief_.landmarks = landmarks_about(5000);
  begin_to_drive(1000);
  for (int n = 0; n < 10; ++n) EXPECT_EQ(step().fault, PlanFault::kNone);
  expect_in_time(kDeadline);
}

// One that is not usable had all that are copied at once; looking for unknown ground never paused;
// nor did what is asked of each of 10,000 frontiers.
TEST_F(StepDeadline, NoPieceTakesLong) {
  RobotDescription robot;
  robot.model = make_model("unicycle");
  PlannerParameters parameters;
  const auto landmarks_with = [&](const std::function<void(LandmarkMap&)>& fault) {
    auto map = std::make_shared<LandmarkMap>(*landmarks_about(200'000));
    fault(*map);
    belief_.landmarks = std::move(map);
    return longest_piece(
        [&](const PausePoint& pause) { step_landmarks(robot, parameters, belief_, pause); });
  };
  give_rooms(belief_, 20.0);
  EXPECT_LT(landmarks_with([](LandmarkMap& m) { m.landmarks.back().survival = 2.0; }), 0.2);
  EXPECT_LT(landmarks_with([](LandmarkMap& m) { m.feature_density = -1.0; }), 0.2);

  // Unknown ground is far off.
  auto known = std::make_shared<VoxelGrid>(GridFrame{0.1, -600, -600, 1200, 1200}, 0.0, 0.1);
  for (int i = -600; i < 600; ++i) {
    for (int j = -600; j < 600; ++j) known->set(i, j, 0, CellState::kFree);
  }
  const GroundMap ground = project(*known, {0.0, 0.1});
  UnseenFeatureOptions unseen;
  unseen.range = 100.0;
  EXPECT_LT(longest_piece([&](const PausePoint& pause) {
              unseen_features(ground, Pose(), unseen, nullptr, pause);
            }),
            0.2);

  give_speckle(belief_, 40.0);
  EXPECT_LT(longest_piece([&](const PausePoint& pause) {
              FrontierPlanner planner(frontier_planner_options_for(robot, parameters));
              planner.update(*belief_.ground, Pose(), 0.0, {}, nullptr, pause);
            }),
            0.1);
}

// Between steps with whole beliefs, one that is not: nothing that is under way is lost by it.
TEST_F(StepDeadline, OfHostileBeliefs) {
  constexpr double kDeadline = 0.01;
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Change = std::function<void(Belief&)>;
  const std::pair<PlanFault, Change> rows[] = {
      {PlanFault::kBelief, [](Belief& b) { b.pose.yaw = kNan; }},
      {PlanFault::kBelief, [](Belief& b) { b.pose.position.x() = 1e300; }},
      {PlanFault::kBelief, [](Belief& b) { b.pose.position.z() = -1e6; }},
      {PlanFault::kBelief, [](Belief& b) { b.twist.linear.x() = kNan; }},
      {PlanFault::kBelief, [](Belief& b) { b.voxels = nullptr; }},
      {PlanFault::kBelief, [](Belief& b) { b.octree = nullptr; }},
      {PlanFault::kNone,
       [](Belief& b) {
         b.pose.position = {5e4, -5e4, 0.0};
       }},
      {PlanFault::kNone,
       [](Belief& b) {
         b.pose.position = {-0.95, 0.5, 0.0};
       }},
      {PlanFault::kNone, [](Belief& b) { b.pose.yaw = 1e9; }},
      {PlanFault::kNone, [](Belief& b) { b.covariance.setConstant(kNan); }},
      {PlanFault::kNone, [](Belief& b) { b.localization = Localization::kLost; }},
      {PlanFault::kNone, [](Belief& b) { b.command->linear.x() = 50.0; }},
      {PlanFault::kNone, [](Belief& b) { b.stamp -= 100.0; }},
      {PlanFault::kNone, [](Belief& b) { give_rooms(b, 8.0, 3000); }},
      {PlanFault::kNone, [](Belief& b) { b.tracked_features = std::numeric_limits<int>::min(); }},
  };
  begin(kDeadline);
  give_rooms(belief_, 20.0);
  begin_to_drive(1000);
  for (std::size_t n = 0; n < std::size(rows); ++n) {
    SCOPED_TRACE(n);
    Belief hostile = belief_;
    rows[n].second(hostile);
    ProcessorStopwatch watch(CLOCK_PROCESS_CPUTIME_ID);
    const Plan plan = planner_->plan(hostile);
    times_.push_back(1e-3 * watch.lap());
    EXPECT_EQ(plan.fault, rows[n].first) << plan.detail;
    EXPECT_FALSE(plan.commands.empty());
    EXPECT_EQ(step().fault, PlanFault::kNone) << plans_.back().detail;
  }
  expect_in_time(kDeadline);
}

// What is under way belongs to what the robot was told before.
TEST_F(StepDeadline, AnotherTaskBeginsAnew) {
  begin(0.001);
  give_rooms(belief_, 20.0);
  EXPECT_EQ(step().fault, PlanFault::kUnfinished);
  Task task;
  task.kind = TaskKind::kGoTo;
  task.goal.position = {2.0, 1.0};
  ASSERT_EQ(planner_->set_task(task), "");
  begin_to_drive(1000);
  EXPECT_EQ(plans_.back().task, TaskKind::kGoTo);
  EXPECT_TRUE(plans_.back().goal.has_value());
  EXPECT_EQ(planner_->global_plan()->target->viewpoint, task.goal.position);
  // The arrival is judged where the robot is, however old the path is.
  belief_.pose.position = {2.0, 1.0, 0.0};
  belief_.twist = {};
  belief_.command = Twist();
  EXPECT_EQ(step().mode.kind, ModeKind::kDone) << plans_.back().why;
  ASSERT_EQ(planner_->set_task({}), "");
  begin_to_drive(1000);
  EXPECT_EQ(plans_.back().task, TaskKind::kExplore);
  ASSERT_EQ(planner_->set_zones({}), "");
  begin_to_drive(1000);
}

// Whole or in pieces, the frontiers are the same.
TEST_F(StepDeadline, PiecesGiveTheSame) {
  give_rooms(belief_, 20.0);
  begin(0.001);
  const Belief first = belief_;
  begin_to_drive(1000);
  const std::shared_ptr<const GlobalPlan> pieces = planner_->global_plan();
  belief_ = first;
  begin(0.0);
  EXPECT_EQ(step().fault, PlanFault::kNone);
  const std::shared_ptr<const GlobalPlan> whole = planner_->global_plan();
  EXPECT_EQ(pieces->cost_to_go->cells().data, whole->cost_to_go->cells().data);
  ASSERT_EQ(pieces->frontiers.size(), whole->frontiers.size());
  for (std::size_t k = 0; k < whole->frontiers.size(); ++k) {
    EXPECT_EQ(pieces->frontiers[k].cells, whole->frontiers[k].cells);
    EXPECT_EQ(pieces->frontiers[k].area, whole->frontiers[k].area);
  }
  EXPECT_EQ(pieces->target->viewpoint, whole->target->viewpoint);
}

}  // namespace
}  // namespace prospect::step_deadline_test
