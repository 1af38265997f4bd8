// SPDX-License-Identifier: Apache-2.0
// Three short missions, step by step: what the robot did, why and where. A change that should not
// change behaviour leaves these files as they are; one that should writes them anew,
//   PROSPECT_WRITE_HISTORIES=1 build/tests/adapters_tests --file=mission_history_test
// and the difference shows what it does.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/files/csv.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "engine/support/named.h"
#include "models/range_text.h"
#include "tests/adapters/record_observer.h"

namespace prospect::mission_history_test {
namespace {

namespace fs = std::filesystem;

// The engine gives the same bits on every processor, the C library's functions do not: theirs at a
// few thousand places, as a number. Histories of another library cannot be compared to the bit.
std::string mathematics() {
  std::uint64_t hash = 1469598103934665603U;
  for (int n = 1; n < 4000; ++n) {
    const double x = 0.0037 * n;
    for (const double y : {std::sin(x), std::cos(x), std::exp(-x), std::log(x), std::atan2(x, 1.7),
                           std::tanh(0.1 * x), std::hypot(x, 2.3), std::erf(0.2 * x)}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &y, sizeof bits);
      hash = (hash ^ bits) * 1099511628211U;
    }
  }
  return std::to_string(hash);
}

struct Told {
  std::string name, world;
  std::uint64_t seed;
  std::string configuration;
  double time_limit;  // [s]
};

// A base of each kind, and between them all modes that a short mission meets.
const Told kMissions[] = {
    {"office", "office", 1, "", 25.0},
    {"corridor_holonomic", "corridor", 2, "robot: {model: holonomic}\n", 25.0},
    {"loop_often_lost", "loop", 1, "simulator: {odometry: {lost_below: 60, degraded_below: 90}}\n",
     50.0},
};

std::string history(const Told& told) {
  Configuration configuration = configuration_from_text(told.configuration, told.name);
  configuration.mission.time_limit = told.time_limit;
  const auto world =
      std::make_shared<const World>(load_world(told.world, world_options_for(configuration)));
  std::string rows =
      "step,estimated_x,estimated_y,estimated_yaw,v,omega,cost,seed,localization,tracked,"
      "mode,cause,since,caution,target_change,target_x,target_y,certificate\n";
  ExplorationRunOptions options;
  options.seed = told.seed;
  options.keep_steps = false;
  test::RecordObserver observer([&](const StepRecord& s) {
    rows += std::to_string(s.step) + ',' + exact_text(s.estimated_pose.position.x()) + ',' +
            exact_text(s.estimated_pose.position.y()) + ',' + exact_text(s.estimated_pose.yaw) +
            ',' + exact_text(s.command.linear.x()) + ',' + exact_text(s.command.yaw_rate) + ',' +
            exact_text(s.explanation.cost) + ',' + csv::field(s.seed) + ',' +
            name_of(s.localization) + ',' + std::to_string(s.tracked_features) + ',' +
            name_of(s.mode) + ',' + name_of(s.cause) + ',' + exact_text(s.mode_since) + ',' +
            name_of(s.safety_level) + ',' + name_of(s.target_change) + ',';
    if (s.target) {
      rows += exact_text(s.target->viewpoint.x()) + ',' + exact_text(s.target->viewpoint.y());
    } else {
      rows += ',';
    }
    rows += ',' + csv::field(s.certificate) + '\n';
  });
  options.observers = std::ref(observer);
  run_exploration(world, configuration, options);
  return rows;
}

TEST(MissionHistory, IsTheSameToTheByte) {
  const fs::path folder = fs::path(PROSPECT_SOURCE_DIR) / "tests" / "histories";
  const std::string library = "mathematics " + mathematics() + '\n';
  const bool write = std::getenv("PROSPECT_WRITE_HISTORIES") != nullptr;
  for (const Told& told : kMissions) {
    SCOPED_TRACE(told.name);
    const fs::path file = folder / (told.name + ".csv");
    if (write) {
      fs::create_directories(folder);
      std::ofstream(file) << library << history(told);
      continue;
    }
    std::ifstream in(file);
    std::string first;
    ASSERT_TRUE(std::getline(in, first)) << file;
    if (first + '\n' != library) {
      GTEST_SKIP() << "this C library's sin, exp and the like differ in the last bit from those "
                      "that the histories were written with";
    }
    std::istringstream now(history(told));
    std::string expected, row;
    int line = 1;
    while (std::getline(in, expected)) {
      ++line;
      ASSERT_TRUE(std::getline(now, row)) << file.filename() << ":" << line << " has no row now";
      ASSERT_EQ(row, expected) << file.filename() << ":" << line << ": the first that differs";
    }
    EXPECT_FALSE(std::getline(now, row)) << "more steps than before: " << row;
  }
}

}  // namespace
}  // namespace prospect::mission_history_test
