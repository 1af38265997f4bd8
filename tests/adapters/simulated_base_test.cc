#include "adapters/simulator/simulated_base.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "adapters/simulator/simulator.h"
#include "models/unicycle.h"
#include "tests/adapters/box_room.h"

namespace prospect::simulated_base_test {
namespace {

Twist forward(double speed) { return {{speed, 0.0, 0.0}, 0.0}; }

/// In the middle of a room, without noise, at a clock that is set by hand.
class SimulatedBaseTest : public ::testing::Test {
 protected:
  void make(const SimulatedBaseOptions& options = {}) {
    SimulatorOptions perfect;
    perfect.odometry.perfect = true;
    simulator_ = std::make_unique<Simulator>(
        std::make_shared<World>(test::box_room(4.0, 3.0, 2.0, 0.1)), perfect);
    base_ = std::make_unique<SimulatedBase>(*simulator_, clock_, model_, options);
  }
  /// x since the start, once the world has come up to date.
  double driven() {
    last_ = base_->update({});
    return base_->truth().pose.position.x() - 2.0;
  }

  ManualClock clock_{50.0};
  Unicycle model_;
  std::unique_ptr<Simulator> simulator_;
  std::unique_ptr<SimulatedBase> base_;
  std::shared_ptr<const Belief> last_;
};

TEST_F(SimulatedBaseTest, DrivesInRealTimeAndStampsInTheRuntimesClock) {
  make();
  base_->send(forward(0.4), 50.15);
  clock_.set(50.1);
  EXPECT_EQ(base_->report().velocity.linear.x(), 0.4);
  EXPECT_EQ(base_->report().stamp, 50.1);
  EXPECT_NEAR(driven(), 0.04, 1e-9);
  ASSERT_TRUE(last_);
  EXPECT_NEAR(last_->stamp, 50.1, 1e-9);
  EXPECT_LE(last_->stamps.map, 50.1);
  EXPECT_GE(last_->stamps.map, 50.0);
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
  SimulatedBaseOptions options;
  options.faults = {parse_fault("link:off@0.2")};
  make(options);
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
  SimulatedBaseOptions options;
  options.faults = {parse_fault("link:delayed")};
  make(options);
  base_->send(forward(0.4), 50.15);  // comes at 50.3
  base_->send(forward(0.2), 50.5);
  clock_.set(51.0);
  EXPECT_NEAR(driven(), 0.2 * 0.2, 1e-9);
}

TEST_F(SimulatedBaseTest, OfASensorThatIsOffTheStampsStay) {
  SimulatedBaseOptions options;
  options.faults = {parse_fault("depth:off@0.5"), parse_fault("cameras:off@1.0")};
  make(options);
  clock_.set(50.4);
  driven();
  const SourceStamps before = last_->stamps;
  const auto map = last_->ground;
  clock_.set(50.9);
  driven();
  EXPECT_EQ(last_->stamps.map, before.map);
  EXPECT_EQ(last_->stamps.ranges, before.ranges);
  EXPECT_EQ(last_->ground, map);
  EXPECT_NEAR(last_->stamps.pose, 50.9, 1e-9);
  clock_.set(51.5);
  base_->send(forward(0.3), 51.6);
  driven();
  EXPECT_NEAR(last_->stamps.pose, 50.9, 1e-9);
  EXPECT_EQ(last_->stamp, last_->stamps.pose);
}

TEST_F(SimulatedBaseTest, WhatTheWheelsMeasureIsWrongAsFaultsSay) {
  SimulatedBaseOptions options;
  options.faults = {parse_fault("wheels:wrong@0+1"), parse_fault("wheels:garbage@1+1"),
                    parse_fault("wheels:off@2+1"), parse_fault("wheels:delayed@3+1")};
  make(options);
  const auto at = [&](double time) {
    clock_.set(50.0 + time - 0.01);
    base_->send(forward(0.4), 60.0);
    clock_.set(50.0 + time);
    return base_->report();
  };
  EXPECT_EQ(at(0.5).velocity.linear.x(), 0.8);
  EXPECT_TRUE(std::isnan(at(1.5).velocity.linear.x()));
  EXPECT_EQ(at(2.5).faults.size(), 1u);
  const BaseReport late = at(3.5);  // told to drive 0.01 s ago: it stood 0.3 s before
  EXPECT_TRUE(late.faults.empty());
  EXPECT_EQ(late.velocity.linear.x(), 0.0);
  clock_.set(53.82);
  EXPECT_EQ(base_->report().velocity.linear.x(), 0.4);
}

TEST_F(SimulatedBaseTest, OfALinkThatIsStuckTheReportStays) {
  SimulatedBaseOptions options;
  options.faults = {parse_fault("link:stuck@1+1")};
  make(options);
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
