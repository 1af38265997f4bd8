// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/planner_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "models/make_model.h"
#include "models/unicycle.h"
#include "tests/engine/planning_scene.h"

namespace prospect::planner_fit_test {
namespace {

using ::testing::HasSubstr;

/// A room of 2 x 2 m, walls included, seen whole, in voxels of `resolution` [m].
Belief room(double resolution) {
  const int n = std::max(3, static_cast<int>(std::lround(2.0 / resolution)));
  VoxelGrid voxels(GridFrame{resolution, 0, 0, n, n}, 0.0, 0.6);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const bool wall = i == 0 || j == 0 || i == n - 1 || j == n - 1;
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        voxels.set(i, j, k, wall ? CellState::kOccupied : CellState::kFree);
      }
    }
  }
  Belief belief;
  belief.pose.position = {0.5 * n * resolution, 0.5 * n * resolution, 0.0};
  belief.ground = std::make_shared<const GroundMap>(project(voxels, {0.1, 0.5}, 8));
  belief.voxels = std::make_shared<const VoxelGrid>(std::move(voxels));
  belief.octree = std::make_shared<const octomap::OcTree>(resolution);
  auto landmarks = std::make_shared<LandmarkMap>();
  for (int i = 0; i < 80; ++i) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(i);
    l.position = {0.02 * i + 0.2, 1.9, 0.4};
    l.creation_direction = -Eigen::Vector3d::UnitY();
    landmarks->landmarks.push_back(l);
  }
  belief.landmarks = std::move(landmarks);
  belief.tracked_features = 80;
  belief.set_stamps(1.0);
  return belief;
}

RobotDescription robot_of(const std::string& model) {
  RobotDescription robot;
  robot.model = make_model(model);
  return robot;
}

Planner planner_of(const RobotDescription& robot, PlannerParameters parameters) {
  parameters.polished = 0;
  return Planner(robot, parameters, std::make_shared<test::IdleSolver>());
}

std::string refusal(const RobotDescription& robot, const PlannerParameters& parameters) {
  try {
    planner_of(robot, parameters);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(PlannerFit, SaysTheNumbersAndWhatWouldFit) {
  PlannerParameters p;
  p.d_des = 5.0;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");
  const std::string why = planner_misfit(robot_of("unicycle"), p, 0.01);
  EXPECT_EQ(why,
            "planner.d_des is 5 m: with the body's radius of 0.18 m and planner.drift_margin of "
            "0.12 m it takes distances up to 5.5 m, 550 voxels at a resolution of 0.01 m; "
            "expected at most 400 voxels: a d_des of at most 3.5 m, or a "
            "perception.mapping.resolution of at least 0.0138 m");
  // What is said to fit does.
  p.d_des = 3.5;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.01), "");
  p.d_des = 5.0;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.0138), "");
  EXPECT_NE(planner_misfit(robot_of("multirotor"), p, 0.05), "");

  p = {};
  p.frontier_planner.cost_to_go.window_radius = 100.0;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");
  EXPECT_EQ(
      planner_misfit(robot_of("unicycle"), p, 0.05),
      "planner.frontiers.window_radius is 100 m, 2000 voxels at a resolution of 0.05 m; "
      "expected at most 1000 voxels: 50 m, or a perception.mapping.resolution of at least 0.1 m");

  p = {};
  p.N = p.M = 120;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1),
            "planner.M is 120: knots of 2 inputs are 240 variables; expected at most 200, an M of "
            "at most 100");
  p.M = 100;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");

  p = {};
  p.max_landmarks = 100000;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");
  p.N = 1000;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1),
            "planner.N is 1000 and planner.max_landmarks 100000: each evaluation looks at 1e+08 "
            "landmarks; expected at most 2e+06, a max_landmarks of at most 2000");
  p.max_landmarks = 2000;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");
  p.deadline = 0.05;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1),
            "planner.N is 1000 and planner.max_landmarks 2000: each evaluation looks at 2e+06 "
            "landmarks; expected at most 5e+05 with a planner.deadline of 0.05 s, a max_landmarks "
            "of at most 500");
  p.max_landmarks = 500;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "");
  p = {};
  p.deadline = 1e-6;
  EXPECT_EQ(planner_misfit(robot_of("unicycle"), p, 0.1), "") << "the default always fits";

  Unicycle::Parameters slow;
  slow.a_max = 1e-6;
  RobotDescription crawler;
  crawler.model = std::make_shared<Unicycle>(slow);
  EXPECT_THAT(planner_misfit(crawler, {}, 0.1),
              HasSubstr("robot.motion: the weakest acceleration is 1e-06 m/s2"));
  EXPECT_THAT(refusal(crawler, {}), HasSubstr("expected more than 0.0002 m/s2"));
}

TEST(PlannerFit, TheConstructorAndEachStepSayTheSame) {
  PlannerParameters p;
  p.d_des = 5.0;
  const RobotDescription robot = robot_of("unicycle");
  const std::string why = planner_misfit(robot, p, 0.01);
  ASSERT_NE(why, "");
  Planner planner = planner_of(robot, p);  // of maps that are not known yet
  const Plan plan = planner.plan(room(0.01));
  EXPECT_EQ(plan.fault, PlanFault::kMisfit);
  EXPECT_THAT(plan.detail, HasSubstr(why));
  EXPECT_FALSE(plan.commands.empty());
  EXPECT_EQ(planner.problem(), nullptr);
  EXPECT_EQ(planner.plan(room(0.1)).fault, PlanFault::kNone) << "other maps fit";
  p.map_resolution = 0.01;
  EXPECT_EQ(refusal(robot, p), why);
  p.map_resolution = -1.0;
  EXPECT_THAT(refusal(robot, p), HasSubstr("map_resolution is -1"));
}

// What a constructor takes, no step refuses: coarse and fine maps, and whatever reach.
TEST(PlannerFit, WhatFitsIsPlannedWith) {
  struct Case {
    const char* what;
    double resolution;
    std::function<void(PlannerParameters&, Unicycle::Parameters&)> set;
  };
  const std::vector<Case> cases = {
      {"1 cm", 0.01, [](auto&, auto&) {}},
      {"1 m", 1.0, [](auto&, auto&) {}},
      {"d_des", 0.1, [](auto& p, auto&) { p.d_des = 5.0; }},
      {"v_max", 0.1, [](auto&, auto& u) { u.v_max = 100.0; }},
      {"v_min", 0.1, [](auto&, auto& u) { u.v_min = -100.0; }},
      {"a_max", 0.1, [](auto&, auto& u) { u.a_max = 1e-3; }},
      {"horizon", 0.1, [](auto& p, auto&) { p.N = 400, p.dt = 5.0, p.committed = 5.0; }},
      {"all", 0.1,
       [](auto& p, auto& u) { p.N = 400, p.dt = 5.0, p.committed = 5.0, u.v_max = 100.0; }},
      {"r_max", 0.1, [](auto& p, auto&) { p.visibility.r_max = 1000.0; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    PlannerParameters parameters;
    Unicycle::Parameters motion;
    c.set(parameters, motion);
    parameters.map_resolution = c.resolution;
    RobotDescription robot;
    robot.model = std::make_shared<Unicycle>(motion);
    Planner planner = planner_of(robot, parameters);
    const Plan plan = planner.plan(room(c.resolution));
    EXPECT_EQ(plan.fault, PlanFault::kNone) << plan.detail;
    ASSERT_NE(planner.problem(), nullptr);
    // Memory follows the room, not the reach.
    EXPECT_LT(planner.specification()->landmark_lattice.nx, 7000);
    EXPECT_LT(planner.specification()->target_lattice.nx, 7000);
  }
}

// A step is a transaction.
TEST(PlanningStep, OfAStepThatFailsNothingIsThere) {
  Planner planner = planner_of(robot_of("unicycle"), {});
  bool fails = false;
  planner.set_cancelled([&] {
    if (fails) throw std::runtime_error("out of order");
    return false;
  });
  const auto whole = [&] {
    const std::shared_ptr<const PlanningStep> step = planner.step();
    EXPECT_TRUE(step->made());
    EXPECT_NE(step->global_plan, nullptr);
    EXPECT_NE(step->specification, nullptr);
    EXPECT_FALSE(step->seeds.empty());
    EXPECT_EQ(step->landmarks.size(), 80U);
    return step;
  };
  const auto nothing = [&] {
    EXPECT_FALSE(planner.step()->made());
    EXPECT_EQ(planner.global_plan(), nullptr);
    EXPECT_EQ(planner.specification(), nullptr);
    EXPECT_TRUE(planner.seeds().empty());
    EXPECT_TRUE(planner.step()->landmarks.empty());
  };
  nothing();
  planner.plan(room(0.1));
  const auto observed = whole();
  const double visibility = observed->landmarks.front().visibility;
  // At its end, after the certificate.
  fails = true;
  const Plan failed = planner.plan(room(0.1));
  fails = false;
  EXPECT_EQ(failed.fault, PlanFault::kError) << failed.detail;
  EXPECT_THAT(failed.detail, HasSubstr("out of order"));
  EXPECT_FALSE(failed.commands.empty());
  nothing();
  EXPECT_EQ(observed->landmarks.size(), 80U) << "who observed a step keeps it";
  EXPECT_EQ(observed->landmarks.front().visibility, visibility);
  const Plan after = planner.plan(room(0.1));
  EXPECT_EQ(after.fault, PlanFault::kNone);
  whole();
  Belief none = room(0.1);
  none.voxels = nullptr;
  EXPECT_EQ(planner.plan(none).fault, PlanFault::kBelief);
  nothing();
  planner.plan(room(0.1));
  Belief torn = room(0.1);
  torn.voxels = room(0.05).voxels;
  const Plan refused = planner.plan(torn);
  EXPECT_EQ(refused.fault, PlanFault::kBelief);
  EXPECT_THAT(refused.detail,
              HasSubstr("the voxels are of 0.05 m and the ground map of 0.1 m; expected the same"));
  nothing();
}

}  // namespace
}  // namespace prospect::planner_fit_test
