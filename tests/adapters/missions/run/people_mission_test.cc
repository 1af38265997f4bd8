// SPDX-License-Identifier: Apache-2.0
// Missions among people who walk.

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "engine/maps/map_projection.h"
#include "runtime/mission.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::people_mission_test {
namespace {

constexpr const char* kRoom =
    "resolution: 0.1\n"
    "textures: {brick: 40}\n"
    "rooms:\n"
    "  - {box: [0, 0, 8, 6], walls: brick, floor: brick}\n"
    "start: [1.0, 1.0, 0.5]\n";

class LastTruth final : public RunObserver {
 public:
  void on_step(const MissionStep& step) override {
    if (step.truth) people = step.truth->people;
    if (step.belief && step.belief->movers) {
      seen += static_cast<int>(step.belief->movers->all.size());
    }
  }
  std::vector<Eigen::Vector2d> people;
  int seen = 0;
};

TEST(PeopleMission, DrivesIntoNobodyAndKeepsNoTrail) {
  NOT_UNDER_SANITIZERS("a mission, of parts that are tested by themselves");
  for (const bool follows : {true, false}) {
    const Configuration c =
        configuration_from_text(std::string("mission: {time_limit: 40}\n"
                                            "task: {kind: explore}\n"
                                            "simulator: {walkers: {count: 4, keep: 1.0}}\n"
                                            "perception: {movers: {enabled: ") +
                                    (follows ? "true}}\n" : "false}}\n"),
                                "people");
    World world = world_from_yaml(kRoom, "a room");
    place_start(world, world_options_for(c).slice, std::nullopt, true);
    LastTruth last;
    ExplorationRunOptions options;
    options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&last}; };
    const ExplorationRunResult result =
        run_exploration(std::make_shared<const World>(std::move(world)), c, options);
    HeightSlice slice = height_slice(c.robot);
    slice.step = c.perception.mapping.slice.step;
    const BeliefMaps maps =
        belief_maps(result.map, slice, c.perception.mapping.z_min, c.perception.mapping.z_max);
    // Cells in the middle of the room that are occupied, with nobody beside them.
    int trail = 0;
    for (int n = 0; n < maps.ground->frame().size(); ++n) {
      const Cell cell = maps.ground->frame().at(n);
      const Eigen::Vector2d at = maps.ground->frame().center(cell);
      if (maps.ground->state(cell) != CellState::kOccupied) continue;
      if (at.x() < 0.6 || at.x() > 7.4 || at.y() < 0.6 || at.y() > 5.4) continue;
      bool beside = false;
      for (const Eigen::Vector2d& person : last.people) beside |= (person - at).norm() < 0.6;
      trail += !beside;
    }
    std::printf("followed: %d; contacts %d, trail %d cells, movers %d\n", follows,
                result.record.summary.collisions, trail, last.seen);
    if (!follows) {
      EXPECT_EQ(last.seen, 0);
      continue;
    }
    EXPECT_GT(last.seen, 20);
    EXPECT_EQ(result.record.summary.collisions, 0);
    EXPECT_LE(trail, 2);
  }
}

}  // namespace
}  // namespace prospect::people_mission_test
