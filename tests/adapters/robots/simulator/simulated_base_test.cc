// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_base.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/simulator/simulator.h"
#include "models/unicycle.h"
#include "tests/adapters/box_room.h"

namespace prospect::simulated_base_test {
namespace {

Twist forward(double speed) { return {{speed, 0.0, 0.0}, 0.0}; }

/// In the middle of a room, without noise, at a clock that is set by hand; with faults, if any, by
/// what breaks any base.
class SimulatedBaseTest : public ::testing::Test {
 protected:
  void make(const SimulatedBaseOptions& options = {}, std::vector<InjectedFault> faults = {}) {
    SimulatorOptions perfect;
    perfect.odometry.perfect = true;
    simulator_ = std::make_unique<Simulator>(
        std::make_shared<World>(test::box_room(4.0, 3.0, 2.0, 0.1)), perfect);
    plain_ = std::make_unique<SimulatedBase>(*simulator_, clock_, model_, options);
    base_.emplace(*plain_, clock_, std::move(faults), plain_->start());
  }
  /// x since the start, once the world has come up to date.
  double driven() {
    plain_->advance(clock_.now());
    return plain_->newest().pose.position.x() - 2.0;
  }

  ManualClock clock_{50.0};
  Unicycle model_;
  std::unique_ptr<Simulator> simulator_;
  std::unique_ptr<SimulatedBase> plain_;
  std::optional<FaultyBase> base_;
};

TEST_F(SimulatedBaseTest, DrivesInRealTimeAndStampsInTheRuntimesClock) {
  make();
  base_->send(forward(0.4), 50.15);
  clock_.set(50.1);
  EXPECT_EQ(base_->report().velocity.linear.x(), 0.4);
  EXPECT_EQ(base_->report().stamp, 50.1);
  EXPECT_NEAR(driven(), 0.04, 1e-9);
}

TEST_F(SimulatedBaseTest, StandsOnceACommandHasExpiredHoweverLateItIsAsked) {
  make();
  base_->send(forward(0.4), 50.15);
  clock_.set(50.05);
  base_->send(forward(0.2), 50.2);
  clock_.set(51.0);
  EXPECT_EQ(base_->report().velocity.linear.x(), 0.0);
  EXPECT_NEAR(driven(), 0.4 * 0.05 + 0.2 * 0.15, 1e-9);
}

TEST_F(SimulatedBaseTest, ItsDeadManStopsIt) {
  SimulatedBaseOptions options;
  options.dead_man = 0.3;
  make(options);
  EXPECT_EQ(base_->dead_man(), 0.3);
  base_->send(forward(0.4), 60.0);
  clock_.set(51.0);
  EXPECT_NEAR(driven(), 0.4 * 0.3, 1e-9);
}

TEST_F(SimulatedBaseTest, StopsAtOnceAndActsLaterWithADelay) {
  SimulatedBaseOptions options;
  options.delay = 0.1;
  make(options);
  base_->send(forward(0.4), 50.3);
  clock_.set(50.1);
  EXPECT_EQ(base_->report().velocity.linear.x(), 0.4);
  clock_.set(50.2);
  base_->stop();
  clock_.set(50.5);
  EXPECT_NEAR(driven(), 0.4 * 0.1, 1e-9);
}

TEST_F(SimulatedBaseTest, WithoutItsLinkItStandsAndIsSilent) {
  make({}, {parse_fault("link:off@0.2")});
  base_->send(forward(0.4), 50.15);
  clock_.set(50.1);
  base_->send(forward(0.4), 50.25);
  EXPECT_EQ(base_->report().stamp, 50.1);
  clock_.set(50.22);
  base_->send(forward(0.4), 50.5);  // does not pass
  clock_.set(51.0);
  EXPECT_EQ(base_->report().stamp, 50.1);
  EXPECT_NEAR(driven(), 0.4 * 0.25, 1e-9);
}

TEST_F(SimulatedBaseTest, ALinkThatIsLateExecutesNothingThatHasExpired) {
  make({}, {parse_fault("link:delayed")});
  base_->send(forward(0.4), 50.15);  // comes at 50.3
  base_->send(forward(0.2), 50.5);
  clock_.set(50.3);
  base_->report();
  clock_.set(51.0);
  EXPECT_NEAR(driven(), 0.2 * 0.2, 1e-9);
}

TEST_F(SimulatedBaseTest, OfALinkThatIsStuckTheReportStays) {
  make({}, {parse_fault("link:stuck@1+1")});
  clock_.set(50.9);
  base_->report();
  clock_.set(51.5);
  base_->send(forward(0.4), 51.6);
  EXPECT_EQ(base_->report().stamp, 50.9);
  clock_.set(52.1);
  EXPECT_EQ(base_->report().stamp, 52.1);
  EXPECT_NEAR(driven(), 0.4 * 0.1, 1e-9);
}

TEST_F(SimulatedBaseTest, OptionsOutOfRangeAreRefused) {
  for (double SimulatedBaseOptions::*value :
       {&SimulatedBaseOptions::dead_man, &SimulatedBaseOptions::belief_period,
        &SimulatedBaseOptions::delay}) {
    SimulatedBaseOptions options;
    options.*value = -1.0;
    EXPECT_THROW(make(options), std::invalid_argument);
    options.*value = std::nan("");
    EXPECT_THROW(make(options), std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect::simulated_base_test
