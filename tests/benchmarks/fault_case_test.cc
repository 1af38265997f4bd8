// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/fault_case.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/run/exploration_run.h"

namespace prospect::fault_case_test {
namespace {

constexpr double kFrom = 5.0, kFor = 3.0, kLength = 12.0;  // [s]

/// Each fault in a drive of its own; two at a time, as each waits for its own threads.
std::map<std::string, FaultOutcome> drive_all(const std::vector<InjectedFault>& faults) {
  Configuration configuration = fault_drive_configuration("corridor");
  // Its odometry is perfect: landmarks that the planner weighs only cost time.
  configuration.planner.max_landmarks = 40;
  const auto world =
      std::make_shared<const World>(load_world("corridor", world_options_for(configuration)));
  std::vector<FaultOutcome> outcomes(faults.size());
  std::atomic<std::size_t> next{0};
  {
    const auto drive = [&] {
      for (std::size_t k = next++; k < faults.size(); k = next++) {
        outcomes[k] =
            drive_with_fault(world, configuration, {.faults = {faults[k]}, .length = kLength});
      }
    };
    const std::jthread one(drive), other(drive);
  }
  std::map<std::string, FaultOutcome> by_name;
  for (std::size_t k = 0; k < faults.size(); ++k) by_name[name_of(faults[k])] = outcomes[k];
  return by_name;
}

/// What must become of a fault.
struct Expected {
  const char* fault;
  const char* cause;     // "": it drives on
  double stop_distance;  // [m] at most
  bool acknowledged;     // a person must
};

TEST(FaultCase, NoFaultEndsInAContactOrASilentStall) {
  const std::vector<Expected> table = {
      {"left-camera:off", "source stale", 0.6, false},
      {"left-camera:stuck", "source stale", 0.6, false},
      {"left-camera:garbage", "source stale", 0.6, false},
      {"left-camera:wrong", "source stale", 0.6, false},
      {"left-camera:slow", "source stale", 0.6, false},
      {"left-camera:delayed", "", 0.0, false},
      {"left-camera:intermittent", "source stale", 0.6, false},
      {"right-camera:off", "source stale", 0.6, false},
      {"right-camera:stuck", "source stale", 0.6, false},
      {"right-camera:garbage", "source stale", 0.6, false},
      {"right-camera:wrong", "source stale", 0.6, false},
      {"right-camera:slow", "source stale", 0.6, false},
      {"right-camera:delayed", "", 0.0, false},
      {"right-camera:intermittent", "source stale", 0.6, false},
      {"cameras:off", "source stale", 0.6, false},
      {"cameras:stuck", "", 0.0, false},
      {"cameras:garbage", "source stale", 0.6, false},
      {"cameras:slow", "source stale", 0.6, false},
      {"cameras:delayed", "", 0.0, false},
      {"cameras:intermittent", "source stale", 0.6, false},
      {"depth:off", "source stale", 0.9, false},
      {"depth:stuck", "", 0.0, false},
      {"depth:garbage", "", 0.0, false},
      {"depth:wrong", "", 0.0, false},
      {"depth:slow", "source stale", 0.9, false},
      {"depth:delayed", "", 0.0, false},
      {"depth:intermittent", "source stale", 0.9, false},
      {"wheels:off", "base fault", 0.09, true},
      {"wheels:stuck", "uncommanded motion", 1.35, true},
      {"wheels:garbage", "uncommanded motion", 0.36, true},
      {"wheels:wrong", "uncommanded motion", 0.36, true},
      {"wheels:slow", "base silent", 0.39, true},
      {"wheels:delayed", "", 0.0, false},
      {"wheels:intermittent", "", 0.0, false},
      {"imu:off", "source stale", 0.6, false},
      {"imu:stuck", "", 0.0, false},
      {"imu:garbage", "source stale", 0.6, false},
      {"imu:wrong", "", 0.0, false},
      {"imu:slow", "source stale", 0.6, false},
      {"imu:delayed", "", 0.0, false},
      {"imu:intermittent", "source stale", 0.6, false},
      {"clock:stuck", "source stale", 0.6, false},
      {"clock:garbage", "source stale", 0.6, false},
      {"clock:wrong", "clock jumped", 0.33, false},
      {"clock:slow", "source stale", 1.68, false},
      {"clock:intermittent", "clock jumped", 0.33, false},
      {"planner:stuck", "tail", 0.51, false},
      {"planner:garbage", "plan", 0.36, false},
      {"planner:wrong", "", 0.0, false},
      {"planner:slow", "", 0.0, false},
      {"planner:intermittent", "tail", 0.51, false},
      {"command:stuck", "expiry", 0.15, false},
      {"command:slow", "expiry", 0.15, false},
      {"command:intermittent", "expiry", 0.15, false},
      {"link:off", "expiry", 0.15, true},
      {"link:stuck", "base silent", 0.39, true},
      {"link:slow", "expiry", 0.18, true},
      {"link:delayed", "expiry", 0.15, true},
      {"link:intermittent", "expiry", 0.15, false},
      {"disk:stuck", "tail", 0.66, false},
      {"disk:slow", "", 0.0, false},
      {"disk:intermittent", "", 0.0, false},
      {"base:inverted", "does not follow", 0.24, true},
      {"base:mirrored", "does not follow", 0.3, true},
      {"base:double", "does not follow", 0.33, true},
      // It stands at once; that nothing comes of what it is told is seen later.
      {"base:ignores", "plan", 0.09, true},
      {"base:runaway", "does not follow", 0.45, true},
      {"base:one-wheel", "does not follow", 0.24, true},
  };
  std::vector<InjectedFault> faults;
  for (const Expected& e : table) {
    faults.push_back(parse_fault(e.fault));
    faults.back().from = kFrom;
    faults.back().duration = kFor;
  }
  const std::map<std::string, FaultOutcome> outcomes = drive_all(faults);
  for (const Expected& e : table) {
    const FaultOutcome& o = outcomes.at(e.fault);
    SCOPED_TRACE(std::string(e.fault) + ": " + to_text(o));
    EXPECT_EQ(o.contacts, 0);
    EXPECT_GT(o.speed, 0.5);
    EXPECT_EQ(o.stop_time ? o.cause : "", e.cause);
    EXPECT_LE(o.stop_distance.value_or(0.0), e.stop_distance);
    EXPECT_EQ(o.acknowledged, e.acknowledged);
    // Whatever stands has said why.
    EXPECT_TRUE(o.drives_at_end || !o.events.empty());
  }
  // Nothing is left out.
  for (const FaultKind& kind : fault_kinds()) {
    const std::string name = name_of({kind.source, kind.verb});
    EXPECT_EQ(outcomes.count(name), kind.implemented ? 1U : 0U) << name;
  }
}

// One goes by its wheels; the other is told its pose, and nothing else tells how it moves.
// On a straight way it is hardly told to turn, so `mirrored` shows later.
TEST(FaultCase, RobotsWithoutCamerasNameABaseThatGoesAstray) {
  for (const LocalizedBy by : {LocalizedBy::kWheels, LocalizedBy::kPose}) {
    const Configuration configuration = fault_drive_configuration("corridor", by);
    const auto world =
        std::make_shared<const World>(load_world("corridor", world_options_for(configuration)));
    for (const char* verb : {"inverted", "mirrored", "double", "ignores", "runaway", "one-wheel"}) {
      InjectedFault fault = parse_fault(std::string("base:") + verb);
      fault.from = 6.0;
      fault.duration = kFor;
      const FaultOutcome o =
          drive_with_fault(world, configuration, {.faults = {fault}, .length = 10.0, .by = by});
      const bool late = by == LocalizedBy::kPose && fault.verb == FaultVerb::kMirrored;
      EXPECT_GT(o.speed, 0.5) << verb;
      EXPECT_EQ(o.contacts, 0) << verb;
      ASSERT_TRUE(o.named_time) << verb;
      EXPECT_TRUE(*o.named_time <= (late ? 2.0 : 1.0) || *o.named_distance <= 0.3)
          << verb << ": " << to_text(o);
    }
  }
}

}  // namespace
}  // namespace prospect::fault_case_test
