// SPDX-License-Identifier: Apache-2.0
// A base of 0.9 x 0.5 m drives through a door and a corridor of 0.9 m.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "tests/adapters/record_observer.h"

namespace prospect::long_body_mission_test {
namespace {

TEST(LongBodyMission, GoesThroughADoorAndACorridorNotMuchWiderThanItself) {
  const Configuration configuration = configuration_from_text(
      "robot:\n"
      "  motion: {v_min: -0.3}\n"
      "  shape: {type: box, size: [0.9, 0.5, 0.4], center: [0, 0, 0.3]}\n"
      "mission: {time_limit: 150}\n",
      "long body");
  World loaded = world_from_yaml(
      "resolution: 0.05\n"
      "textures: {brick: 40, carpet: 35}\n"
      "rooms:\n"
      "  - {box: [0, 0, 3, 3], walls: brick, floor: carpet}\n"
      "  - {box: [3.2, 0, 6.2, 3], walls: brick, floor: carpet}\n"
      "  - {box: [6.2, 1.05, 8.2, 1.95], walls: brick, floor: carpet}\n"
      "  - {box: [8.2, 0, 11.2, 3], walls: brick, floor: carpet}\n"
      "doors:\n"
      "  - {box: [2.9, 1.05, 3.3, 1.95], height: 2.1}\n"
      "start: [1.5, 1.5, 0]\n",
      "door and corridor");
  place_start(loaded, world_options_for(configuration).slice, std::nullopt, true);
  const auto world = std::make_shared<const World>(std::move(loaded));
  double farthest = 0.0, coverage = 0.0;
  ExplorationRunOptions options;
  options.keep_steps = false;
  test::RecordObserver observer([&](const StepRecord& step) {
    farthest = std::max(farthest, step.true_pose.position.x());
    coverage = step.coverage;
  });
  options.observers = std::ref(observer);
  options.cancelled = [&] { return farthest > 8.6 && coverage > 0.97; };
  const Summary summary = run_exploration(world, configuration, options).record.summary;
  EXPECT_GT(farthest, 8.6) << "into the last room";
  EXPECT_GT(summary.coverage, 0.97);
  EXPECT_NEAR(summary.reachable_area_m2, 28.8, 0.3);
  EXPECT_LT(summary.too_long_for_m2, 0.1);
  EXPECT_LE(summary.area_m2, summary.reachable_area_m2 + 1e-9);
  EXPECT_EQ(summary.collisions, 0);
}

}  // namespace
}  // namespace prospect::long_body_mission_test
