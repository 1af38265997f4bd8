// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/progress_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace prospect::progress_monitor_test {
namespace {

const Eigen::Vector2d kPlace(1.0, 2.0);

// V along x, to a target at x = 9: on a straight path, `longer` than that.
ProgressMonitor::CostToGoAt straight(double longer = 0.0) {
  return [longer](const Eigen::Vector2d& p) { return 9.0 - p.x() + longer; };
}

Eigen::Vector2d at(double x) { return {x, 2.0}; }

TEST(ProgressMonitor, StallsAndBecomesHopelessOfWhoStands) {
  ProgressMonitor monitor({});
  for (double t = 0.0; t <= 9.0; t += 0.5) {
    monitor.begin(t, 10.0);
    monitor.update(true, kPlace, straight(), 10.0);
    EXPECT_EQ(monitor.stalled_for(), t);
    EXPECT_EQ(monitor.stalled(), t >= 3.0) << t;
    EXPECT_EQ(monitor.hopeless(), t >= 8.0) << t;
  }
  monitor.given_up(10.0);
  EXPECT_FALSE(monitor.stalled());
  EXPECT_FALSE(monitor.hopeless());
}

// What was seen ends it; coming nearer alone does not, since that is what it does when stalled.
TEST(ProgressMonitor, IsStalledUntilSomethingNewIsSeenOrTheTargetIsAnother) {
  const auto stalled = [] {
    ProgressMonitor monitor({});
    for (const double t : {0.0, 3.0}) {
      monitor.begin(t, 10.0);
      monitor.update(true, at(1.0), straight(), 10.0);
    }
    EXPECT_TRUE(monitor.stalled());
    monitor.begin(3.5, 10.0);
    return monitor;
  };
  ProgressMonitor nearer = stalled();
  nearer.update(true, at(1.3), straight(), 10.0);
  EXPECT_EQ(nearer.stalled_for(), 0.0);
  EXPECT_TRUE(nearer.stalled());
  // ... until it has got away from there.
  nearer.begin(4.0, 10.0);
  nearer.update(true, at(1.9), straight(), 10.0);
  EXPECT_TRUE(nearer.stalled());
  nearer.begin(4.5, 10.0);
  nearer.update(true, at(2.1), straight(), 10.0);
  EXPECT_FALSE(nearer.stalled());
  ProgressMonitor seen = stalled();
  seen.update(true, at(1.0), straight(), 10.2);
  EXPECT_FALSE(seen.stalled());
  ProgressMonitor other = stalled();
  other.update(false, at(1.0), straight(), 10.0);
  EXPECT_TRUE(other.stalled()) << "the clock runs on: targets that alternate are no progress";
  ProgressMonitor dropped = stalled();
  dropped.target_dropped();
  EXPECT_FALSE(dropped.stalled());
  ProgressMonitor none = stalled();
  none.no_target();
  EXPECT_FALSE(none.stalled());
  EXPECT_EQ(none.stalled_for(), 0.0);
}

// One visit, second by second: where the robot is, how much longer the path is than a straight one,
// what it does, and for how long it has made no progress by then.
struct Second {
  double x, longer;  // [m]
  enum { kPursues, kRetreats, kOther } does;
  double stalled_for;  // [s]
};

void expect(const std::vector<Second>& seconds) {
  ProgressMonitor monitor({});
  monitor.begin(0.0, 10.0);
  monitor.update(false, at(seconds.front().x), straight(seconds.front().longer), 10.0);
  double t = 0.0;
  for (const Second& s : seconds) {
    t += 1.0;
    if (s.does == Second::kRetreats) monitor.hold(t);
    monitor.begin(t, 10.0);
    monitor.update(s.does != Second::kOther, at(s.x), straight(s.longer), 10.0);
    EXPECT_EQ(monitor.stalled_for(), s.stalled_for) << "second " << t;
  }
}

constexpr auto kPursues = Second::kPursues;
constexpr auto kRetreats = Second::kRetreats;

// Each retreat takes it back to x = 0; what it regains is no progress, however often.
TEST(ProgressMonitor, WhatARetreatGaveAwayAndIsRegainedIsNoProgress) {
  expect({{0.0, 0.0, kPursues, 1.0},
          {2.0, 0.0, kPursues, 0.0},
          {3.0, 0.0, kPursues, 0.0},
          {1.0, 0.0, kRetreats, 0.0},
          {0.0, 0.0, kRetreats, 0.0},
          {1.5, 0.0, kPursues, 1.0},
          {2.9, 0.0, kPursues, 2.0},
          {1.0, 0.0, kRetreats, 2.0},
          {0.0, 0.0, kRetreats, 2.0},
          {1.5, 0.0, kPursues, 3.0},
          {2.9, 0.0, kPursues, 4.0},
          {3.1, 0.0, kPursues, 5.0},
          {3.3, 0.0, kPursues, 0.0}});
}

// A robot that circles before a door gives its own way away.
TEST(ProgressMonitor, ToAndFroIsNoProgress) {
  expect({{2.0, 0.0, kPursues, 1.0},
          {3.0, 0.0, kPursues, 0.0},
          {2.0, 0.0, kPursues, 1.0},
          {3.0, 0.0, kPursues, 2.0},
          {2.0, 0.0, kPursues, 3.0},
          {3.0, 0.0, kPursues, 4.0}});
}

// A door that turns out closed: progress is against what the way round costs.
TEST(ProgressMonitor, OnAPathThatHasBecomeLongerItIsAgainstWhatThatCosts) {
  expect({{2.0, 0.0, kPursues, 1.0},
          {3.0, 0.0, kPursues, 0.0},
          {3.0, 20.0, kPursues, 1.0},
          {3.5, 20.0, kPursues, 0.0},
          {3.5, 0.0, kPursues, 1.0},
          {3.6, 0.0, kPursues, 2.0},
          {3.8, 0.0, kPursues, 0.0}});
}

// A door that noise opens and closes moves the cost-to-go up and down for ever.
TEST(ProgressMonitor, AFallOfTheCostToGoUnderARobotThatStandsIsNone) {
  expect({{2.0, 3.0, kPursues, 1.0},
          {2.0, 0.0, kPursues, 2.0},
          {2.0, 3.0, kPursues, 3.0},
          {2.0, 0.0, kPursues, 4.0}});
}

TEST(ProgressMonitor, AnotherTargetIsAnotherVisitOnTheSameClock) {
  expect({{3.0, 0.0, kPursues, 1.0},
          {1.0, 0.0, Second::kOther, 2.0},
          {1.1, 0.0, kPursues, 3.0},
          {1.3, 0.0, kPursues, 0.0}});
}

// Where the nearest place is a wall by now there is nothing to compare with, which is no progress.
TEST(ProgressMonitor, APlaceOfWhichTheCostToGoSaysNothingIsForgotten) {
  ProgressMonitor monitor({});
  const auto step = [&](double t, double x, double wall) {
    monitor.begin(t, 10.0);
    monitor.update(
        true, at(x),
        [&](const Eigen::Vector2d& p) {
          return p.x() == wall ? std::numeric_limits<double>::infinity() : 9.0 - p.x();
        },
        10.0);
    return monitor.stalled_for();
  };
  EXPECT_EQ(step(0.0, 3.0, 0.0), 0.0);
  EXPECT_EQ(step(1.0, 1.0, 3.0), 1.0);
  EXPECT_EQ(step(2.0, 1.1, 0.0), 2.0);
  EXPECT_EQ(step(3.0, 1.3, 0.0), 0.0);
  // Places have moved: the robot has not.
  monitor.follow([](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() - 5.0, p.y()); });
  EXPECT_EQ(step(4.0, -3.7, 0.0), 1.0);
}

TEST(ProgressMonitor, AVisitThatIsLostTwiceWithoutProgressInBetweenHasFailed) {
  ProgressMonitor monitor({});
  double t = 0.0;
  const auto step = [&](bool same, double x, double explored) {
    monitor.begin(t += 1.0, explored);
    monitor.update(same, at(x), straight(), explored);
  };
  step(false, 0.0, 10.0);
  EXPECT_FALSE(monitor.lost_again());
  EXPECT_TRUE(monitor.lost_again());
  step(true, 0.1, 10.0);
  EXPECT_TRUE(monitor.lost_again());
  step(true, 0.5, 10.0);
  EXPECT_FALSE(monitor.lost_again()) << "nearer";
  step(true, 0.5, 11.0);
  EXPECT_FALSE(monitor.lost_again()) << "seen";
  step(false, 0.5, 11.0);
  EXPECT_FALSE(monitor.lost_again()) << "another";
}

TEST(ProgressMonitor, EnoughExploredIsProgress) {
  ProgressMonitor just_enough({.area = 0.5});
  just_enough.begin(0.0, 10.0);
  just_enough.begin(1.0, 10.0);
  just_enough.update(true, kPlace, straight(), 10.5);
  EXPECT_EQ(just_enough.stalled_for(), 0.0);
}

TEST(ProgressMonitor, TimeWithSomethingElseToDoDoesNotCount) {
  ProgressMonitor monitor({});
  monitor.hold(5.0);
  monitor.begin(0.0, 10.0);
  monitor.update(true, kPlace, straight(), 10.0);
  monitor.hold(20.0);
  monitor.begin(20.0, 10.0);
  monitor.update(true, kPlace, straight(), 10.0);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.begin(22.0, 10.0);
  monitor.update(true, kPlace, straight(), 10.0);
  EXPECT_EQ(monitor.stalled_for(), 2.0);
  // A clock that jumps back does not freeze it.
  monitor.begin(1.0, 10.0);
  monitor.update(true, kPlace, straight(), 10.0);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
}

TEST(ProgressMonitor, OptionsOutOfRangeAreRefused) {
  using Options = ProgressMonitor::Options;
  for (const Options& bad : {Options{.stalled_after = 9.0}, Options{.stalled_after = 0.0},
                             Options{.distance = -1.0}, Options{.area = 0.0}}) {
    EXPECT_THROW(ProgressMonitor{bad}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect::progress_monitor_test
