// SPDX-License-Identifier: Apache-2.0
#include "runtime/simulation_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

namespace prospect::simulation_clock_test {
namespace {

TEST(SimulationClock, GoesOnFromTickToTick) {
  ManualClock machine(1000.0);
  SimulationClock clock(machine);
  EXPECT_EQ(clock.now(), 0.0);
  clock.tick(50.0);
  EXPECT_EQ(clock.now(), 50.0);
  // A second of the world takes 4 of the machine: once the rate is known, the clock goes on evenly.
  for (int k = 1; k <= 100; ++k) {
    machine.advance(0.02);
    const double before = clock.now();
    machine.advance(0.02);
    const double now = clock.now();
    clock.tick(50.0 + 0.01 * k);
    EXPECT_GE(clock.now(), 50.0 + 0.01 * k);
    EXPECT_LE(clock.now(), 50.0 + 0.01 * k + 0.03);
    if (k > 30) {
      EXPECT_NEAR(now - before, 0.005, 1e-6) << k;
    }
  }
}

TEST(SimulationClock, StandsWithTheSimulationAndGoesOnOnceItIsLost) {
  ManualClock machine(1000.0);
  SimulationClock clock(machine);
  clock.tick(50.0);
  machine.advance(0.05);
  EXPECT_NEAR(clock.now(), 50.05, 1e-9);
  // As a world that waits for its images on a machine with other work.
  machine.advance(1.4);
  EXPECT_NEAR(clock.now(), 50.0 + SimulationClock::kAhead, 1e-9);
  machine.advance(8.55);
  EXPECT_NEAR(clock.now(), 55.1, 1e-9);
  // It is back: time stands until ticks have caught up, and never goes back.
  clock.tick(50.2);
  EXPECT_NEAR(clock.now(), 55.1, 1e-9);
  machine.advance(0.1);
  clock.tick(51.0);
  EXPECT_NEAR(clock.now(), 55.1, 1e-9);
  machine.advance(1.1);
  clock.tick(61.0);
  EXPECT_NEAR(clock.now(), 61.0, 1e-9);
}

TEST(SimulationClock, TakesNoTimeThatIsNone) {
  ManualClock machine(1000.0);
  SimulationClock clock(machine);
  clock.tick(std::nan(""));
  clock.tick(std::numeric_limits<double>::infinity());
  machine.advance(3.0);
  EXPECT_NEAR(clock.now(), 3.0, 1e-9);  // nothing has ticked
  clock.tick(7.0);
  clock.tick(6.0);
  EXPECT_EQ(clock.now(), 7.0);
}

// Else one wrong message ends the mission: no later tick would reach it.
TEST(SimulationClock, OneTickFarAheadDecidesNothing) {
  ManualClock machine(1000.0);
  SimulationClock clock(machine);
  double now = 50.0;
  const auto go = [&] {
    machine.advance(0.05);
    clock.tick(now += 0.05);
  };
  for (int k = 0; k < 20; ++k) go();
  clock.tick(1e9);
  EXPECT_NEAR(clock.now(), now, 0.06);
  go();
  EXPECT_NEAR(clock.now(), now, 1e-9);
  clock.tick(700.0);
  clock.tick(2e9);  // nor do two that do not agree
  clock.tick(300.0);
  go();
  EXPECT_NEAR(clock.now(), now, 1e-9);
  // A simulation that has leapt goes on from there.
  clock.tick(now = 900.0);
  go();
  EXPECT_NEAR(clock.now(), now, 1e-9);
  // Ten seconds of silence are none.
  machine.advance(10.0);
  clock.tick(910.0);
  EXPECT_NEAR(clock.now(), 910.0, 1e-9);
}

TEST(SimulationClock, WaitsForItsOwnTime) {
  const SteadyClock machine;
  SimulationClock clock(machine);
  clock.tick(100.0);
  std::stop_source stop;
  std::jthread ticks([&] {
    clock.tick(200.0);
    clock.tick(200.1);
  });
  EXPECT_TRUE(clock.wait_until(150.0, stop.get_token()));
  EXPECT_GE(clock.now(), 200.0);
  stop.request_stop();
  EXPECT_FALSE(clock.wait_until(1e9, stop.get_token()));
}

}  // namespace
}  // namespace prospect::simulation_clock_test
