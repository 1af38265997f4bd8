// SPDX-License-Identifier: Apache-2.0
// Missions among people who walk.

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
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

class MoverCount final : public RunObserver {
 public:
  void on_step(const MissionStep& step) override {
    if (step.belief && step.belief->movers) {
      seen += static_cast<int>(step.belief->movers->all.size());
    }
  }
  int seen = 0;
};

TEST(PeopleMission, DrivesIntoNobody) {
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
    MoverCount last;
    ExplorationRunOptions options;
    options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&last}; };
    const ExplorationRunResult result =
        run_exploration(std::make_shared<const World>(std::move(world)), c, options);
    std::printf("followed: %d; contacts %d, movers %d\n", follows, result.record.summary.collisions,
                last.seen);
    if (!follows) {
      EXPECT_EQ(last.seen, 0);
      continue;
    }
    EXPECT_GT(last.seen, 20);
    EXPECT_EQ(result.record.summary.collisions, 0);
  }
}

}  // namespace
}  // namespace prospect::people_mission_test
