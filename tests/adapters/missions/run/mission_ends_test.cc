// SPDX-License-Identifier: Apache-2.0
// How small missions end: what was asked for, and what is said of it.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::mission_ends_test {
namespace {

std::shared_ptr<const World> world_of(const std::string& yaml, const Configuration& configuration) {
  World world = world_from_yaml(yaml, "a small world");
  place_start(world, world_options_for(configuration).slice, std::nullopt, true);
  return std::make_shared<const World>(std::move(world));
}

Summary run(const std::string& yaml, const Configuration& configuration) {
  ExplorationRunOptions options;
  options.keep_steps = false;
  return run_exploration(world_of(yaml, configuration), configuration, options).record.summary;
}

constexpr const char* kOneRoom =
    "resolution: 0.1\n"
    "textures: {brick: 40}\n"
    "rooms:\n"
    "  - {box: [0, 0, 4, 3], walls: brick, floor: brick}\n"
    "start: [0.4, 0.4, 3.9]\n";

constexpr const char* kThreeRooms =
    "resolution: 0.1\n"
    "textures: {brick: 40}\n"
    "rooms:\n"
    "  - {box: [0, 0, 3, 3], walls: brick, floor: brick}\n"
    "  - {box: [3.2, 0, 6.2, 3], walls: brick, floor: brick}\n"
    "  - {box: [6.4, 0, 9.4, 3], walls: brick, floor: brick}\n"
    "doors:\n"
    "  - {box: [2.9, 1, 3.3, 2]}\n"
    "  - {box: [6.1, 1, 6.5, 2]}\n"
    "start: [1.5, 1.5, 3.14]\n";

// It began with its nose in a corner, where nothing is to be tracked: it cannot stand there again.
// A calibration that errs would have it stand elsewhere, where it can.
TEST(MissionEnds, AReturnToAHeadingThatCannotBeHadEnds) {
  Configuration configuration = configuration_from_text(
      "simulator: {odometry: {scale_error: 0, direction_error: 0, turn_error: 0}}\n"
      "mission: {time_limit: 60, return_when_done: true}\n",
      "one room");
  const Summary s = run(kOneRoom, configuration);
  EXPECT_EQ(s.end, MissionEnd::kExplored) << s.detail;
  EXPECT_TRUE(s.done) << s.detail;
  EXPECT_LT(s.duration_s, 50.0);
  EXPECT_GT(s.heading_missed_deg, 9.0) << s.detail;
  EXPECT_NE(s.detail.find("degrees off the heading there"), std::string::npos) << s.detail;
}

// Nothing of it is in view from where it is; the room between is crossed, not explored.
TEST(MissionEnds, AnAreaFarFromWhatIsKnownIsExplored) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  const Configuration configuration = configuration_from_text(
      "mission: {time_limit: 90}\n"
      "task: {area: [7, 0.2, 12, 0.2, 12, 2.8, 7, 2.8]}\n",  // half out of the world
      "area");
  const Summary s = run(kThreeRooms, configuration);
  EXPECT_EQ(s.end, MissionEnd::kExplored) << s.detail;
  EXPECT_EQ(outcome(s), Outcome::kDone);
  EXPECT_GT(s.coverage, 0.95);
  EXPECT_NEAR(s.reachable_area_m2, 6.2, 0.3);
}

TEST(MissionEnds, AnAreaThatAZoneCutsOffIsUnreachableAndTheZoneIsNamed) {
  const Configuration configuration = configuration_from_text(
      "mission: {time_limit: 60}\n"
      "task: {area: [7, 0.2, 9, 0.2, 9, 2.8, 7, 2.8]}\n"
      "zones: {keep_out: [{area: [3.4, -1, 5, -1, 5, 4, 3.4, 4]}]}\n",
      "zone");
  const Summary s = run(kThreeRooms, configuration);
  EXPECT_EQ(s.end, MissionEnd::kUnreachable) << s.detail;
  EXPECT_EQ(outcome(s), Outcome::kNotDone);
  EXPECT_NE(s.detail.find("zones.keep_out[0] bars every way there"), std::string::npos) << s.detail;
}

TEST(MissionEnds, AStartInAZoneIsRefused) {
  for (const auto& [zones, told] :
       {std::pair{"{keep_out: [{area: [5, 0, 6, 0, 6, 3]}, {area: [1, 1, 2, 1, 2, 2, 1, 2]}]}",
                  "zones.keep_out[1]: the robot at the start (1.5, 1.5) is in it"},
        {"{bound: [1.45, 0, 9, 0, 9, 3, 1.45, 3]}",
         "zones.bound: the robot at the start (1.5, 1.5) is beyond it"}}) {
    const Configuration configuration =
        configuration_from_text(std::string("zones: ") + zones + "\n", "zones");
    try {
      run(kThreeRooms, configuration);
      FAIL() << zones;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(told), 0u) << error.what();
    }
  }
}

}  // namespace
}  // namespace prospect::mission_ends_test
