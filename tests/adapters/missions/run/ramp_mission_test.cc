// SPDX-License-Identifier: Apache-2.0
// Missions over thresholds and ramps.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/sloped_floor.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "runtime/mission.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::ramp_mission_test {
namespace {

struct Explored {
  double highest = 0.0;   // [m] of the floor under the robot
  double farthest = 0.0;  // [m] along x
  double coverage = 0.0;
  int contacts = 0;
  bool fallen = false;
};

Explored explore(const std::string& yaml, double time_limit) {
  World world = world_from_yaml(yaml, "ramps");
  const Configuration c = configuration_from_text(
      "mission: {time_limit: " + std::to_string(time_limit) + "}\ntask: {kind: explore}\n",
      "ramps");
  place_start(world, world_options_for(c).slice, std::nullopt, true);
  const auto shared = std::make_shared<const World>(std::move(world));
  const ExplorationRunResult result = run_exploration(shared, c, {});
  Explored e;
  for (const StepRecord& step : result.record.steps) {
    const Eigen::Vector2d at = step.true_pose.position.head<2>();
    e.highest = std::max(e.highest, floor_height(*shared, at));
    e.farthest = std::max(e.farthest, at.x());
  }
  const Summary& s = result.record.summary;
  e.coverage = s.coverage;
  e.contacts = s.collisions;
  e.fallen = s.end == MissionEnd::kFallen;
  std::printf("highest %.3f m, farthest %.2f m, coverage %.3f, contacts %d, fallen %d, %.1f s\n",
              e.highest, e.farthest, e.coverage, e.contacts, e.fallen, s.duration_s);
  return e;
}

std::string two_rooms(double threshold) {
  return "resolution: 0.1\n"
         "textures: {brick: 40}\n"
         "rooms:\n"
         "  - {box: [0, 0, 4, 4], walls: brick, floor: brick}\n"
         "  - {box: [4.2, 0, 8, 4], walls: brick, floor: brick}\n"
         "doors: [{box: [3.9, 1.2, 4.3, 2.8]}]\n"
         "ramps: [{box: [3.95, 1, 4.25, 3], z: [" +
         std::to_string(threshold) + ", " + std::to_string(threshold) +
         "]}]\n"
         "start: [1, 2, 0]\n";
}

TEST(RampMission, DrivesOverAThresholdUpToTheStepAndNotOverAHigherOne) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  const Explored low = explore(two_rooms(0.04), 60.0);
  EXPECT_GT(low.farthest, 5.0);
  EXPECT_GT(low.coverage, 0.95);
  const Explored high = explore(two_rooms(0.08), 60.0);
  EXPECT_LT(high.farthest, 4.0);
  EXPECT_GT(high.coverage, 0.95);
  for (const Explored& e : {low, high}) {
    EXPECT_EQ(e.contacts, 0);
    EXPECT_FALSE(e.fallen);
  }
}

std::string hall_with_dock(double foot) {
  return "resolution: 0.1\n"
         "textures: {brick: 40}\n"
         "rooms: [{box: [0, 0, 11, 6], walls: brick, floor: brick}]\n"
         "ramps:\n"
         "  - {box: [" +
         std::to_string(foot) +
         ", 2, 6.6, 4], z: [0, 0.5], up: east}\n"
         "  - {box: [6.6, 1, 9, 5], z: [0.5, 0.5]}\n"
         "furniture: [{name: gallery, box: [0, 4.2, 5, 6], z: [1.2, 1.4], texture: brick}]\n"
         "start: [1, 3, 0]\n";
}

TEST(RampMission, ClimbsAGentleRampAndNotASteepOne) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  const Explored gentle = explore(hall_with_dock(3.04), 120.0);  // 8 degrees
  EXPECT_NEAR(gentle.highest, 0.5, 1e-6);                        // on the dock
  EXPECT_GT(gentle.coverage, 0.95);
  const Explored steep = explore(hall_with_dock(4.25), 120.0);  // 12 degrees
  EXPECT_LT(steep.highest, 0.02);                               // at its foot at most
  EXPECT_GT(steep.coverage, 0.95);
  for (const Explored& e : {gentle, steep}) {
    EXPECT_EQ(e.contacts, 0);
    EXPECT_FALSE(e.fallen);
  }
}

}  // namespace
}  // namespace prospect::ramp_mission_test
