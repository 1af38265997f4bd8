// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/baseline_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/simulator.h"
#include "tests/adapters/record_observer.h"

namespace prospect::baseline_planner_test {
namespace {

constexpr const char* kTwoRooms = R"(
name: two rooms
resolution: 0.1
wall_height: 1.0
wall_thickness: 0.2
textures: {brick: 20}
rooms:
  - {name: west, box: [0, 0, 4, 4], walls: brick, floor: brick}
  - {name: east, box: [4.2, 0, 8.2, 4], walls: brick, floor: brick}
doors:
  - {box: [3.9, 1.4, 4.3, 2.4]}
furniture:
  - {name: desk, box: [5.6, 2.6, 6.6, 3.2], z: [0, 0.8], texture: brick}
start: [1.0, 1.0, 0.0]
)";

Configuration configuration() {
  return configuration_from_text(
      "simulator: {odometry: {perfect: true}}\nmission: {time_limit: 150}\n", "test");
}

std::shared_ptr<const World> two_rooms() {
  return std::make_shared<const World>(world_from_yaml(kTwoRooms, "two rooms"));
}

class EveryRule : public ::testing::TestWithParam<FrontierRule> {};

TEST_P(EveryRule, ExploresTwoRoomsWithoutTouchingAnything) {
  ExplorationRunOptions options;
  options.make_planner = [](const Configuration& c) {
    return std::make_unique<BaselinePlanner>(GetParam(), c.robot, c.planner);
  };
  int standing = 0, longest_standing = 0;
  test::RecordObserver observer([&](const StepRecord& step) {
    const bool stands = step.command.linear.norm() < 1e-3 && std::abs(step.command.yaw_rate) < 1e-3;
    standing = stands ? standing + 1 : 0;
    longest_standing = std::max(longest_standing, standing);
  });
  options.observers = std::ref(observer);
  options.keep_steps = false;
  const Summary s = run_exploration(two_rooms(), configuration(), options).record.summary;
  EXPECT_EQ(s.end, MissionEnd::kExplored);
  EXPECT_GE(s.coverage, 0.98);
  EXPECT_EQ(s.collisions, 0);
  // 8 m of floor to cross at 0.6 m/s and a few turns of 6 s.
  EXPECT_LT(s.time_to_95_s, 75.0);
  // Looking in vain takes four looks, each 0.5 s; more is dithering.
  EXPECT_LE(longest_standing, 12);
}

TEST_P(EveryRule, TheSameMissionTwiceGivesTheSameBits) {
  std::vector<Pose> poses[2];
  for (std::vector<Pose>& out : poses) {
    Configuration c = configuration();
    c.mission.time_limit = 20.0;
    ExplorationRunOptions options;
    options.make_planner = [](const Configuration& k) {
      return std::make_unique<BaselinePlanner>(GetParam(), k.robot, k.planner);
    };
    test::RecordObserver observer([&](const StepRecord& step) { out.push_back(step.true_pose); });
    options.observers = std::ref(observer);
    run_exploration(two_rooms(), c, options);
  }
  ASSERT_EQ(poses[0].size(), poses[1].size());
  for (std::size_t i = 0; i < poses[0].size(); ++i) {
    EXPECT_EQ(poses[0][i].position, poses[1][i].position);
    EXPECT_EQ(poses[0][i].yaw, poses[1][i].yaw);
  }
}

INSTANTIATE_TEST_SUITE_P(BaselinePlanner, EveryRule,
                         ::testing::Values(FrontierRule::kNearest, FrontierRule::kCostUtility),
                         [](const auto& info) {
                           return info.param == FrontierRule::kNearest ? "nearest" : "cost_utility";
                         });

TEST(BaselinePlanner, BeliefsThatCannotBeUsedGiveAStop) {
  const Configuration c = configuration();
  Simulator simulator(two_rooms(), c.simulator, c.perception);
  const Belief good = *simulator.sense();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Belief> beliefs(5, good);
  beliefs[0].voxels = nullptr;
  beliefs[1].ground = nullptr;
  beliefs[2].pose.position.x() = nan;
  beliefs[3].twist.yaw_rate = std::numeric_limits<double>::infinity();
  beliefs[4].stamp = nan;
  BaselinePlanner planner(FrontierRule::kNearest, c.robot, c.planner);
  for (const Belief& belief : beliefs) {
    const Plan plan = planner.plan(belief);
    EXPECT_EQ(plan.kind, PlanKind::kStoppingTail);
    ASSERT_FALSE(plan.commands.empty());
    for (const Twist& command : plan.commands) {
      EXPECT_EQ(command.linear.norm(), 0.0);
      EXPECT_EQ(command.yaw_rate, 0.0);
    }
    EXPECT_FALSE(plan.detail.empty());
  }
  EXPECT_TRUE(planner.plan(good).certified);
}

TEST(BaselinePlanner, ParametersOutOfRangeAreRefused) {
  const Configuration c = configuration();
  PlannerParameters p = c.planner;
  p.committed = 0.5 * p.dt;
  EXPECT_THROW(BaselinePlanner(FrontierRule::kNearest, c.robot, p), std::invalid_argument);
  p = c.planner;
  p.d_des = p.d_safe;
  EXPECT_THROW(BaselinePlanner(FrontierRule::kNearest, c.robot, p), std::invalid_argument);
  RobotDescription robot = c.robot;
  robot.model = nullptr;
  EXPECT_THROW(BaselinePlanner(FrontierRule::kNearest, robot, c.planner), std::invalid_argument);
}

TEST(NearestFrontierParameters, LeaveTheChoiceOfTheNearestOnly) {
  const PlannerParameters before = configuration().planner;
  const PlannerParameters p = nearest_frontier_parameters(before);
  ASSERT_TRUE(p.frontier_planner.rule);
  const std::vector<FrontierCandidate> candidates{
      {.frontier = 4, .area = 9.0, .cost = 1.0, .time = 1.0, .path = 3.0, .length = 1.0},
      {.frontier = 7, .area = 0.2, .cost = 9.0, .time = 9.0, .path = 2.0, .length = 1.0},
      {.frontier = 9, .area = 5.0, .cost = 5.0, .time = 5.0, .path = 2.5, .length = 1.0}};
  EXPECT_EQ(p.frontier_planner.rule(candidates, 0), 1) << "the shortest path";
  EXPECT_GT(p.frontier_planner.reconsider, 1e6) << "kept until it is seen";
  EXPECT_EQ(p.weights.visible_features, 0.0);
  EXPECT_TRUE(p.target_frontier_only);
  EXPECT_EQ(p.weights.exploration_gain, before.weights.exploration_gain);
  EXPECT_EQ(p.weights.cost_to_go, before.weights.cost_to_go);
  EXPECT_EQ(p.N, before.N);
}

}  // namespace
}  // namespace prospect::baseline_planner_test
