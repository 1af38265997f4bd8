// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/progress_monitor.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace prospect::progress_monitor_test {
namespace {

const Eigen::Vector2d kPlace(1.0, 2.0);

TEST(ProgressMonitor, StallsAndBecomesHopelessOfWhoStands) {
  ProgressMonitor monitor({});
  for (double t = 0.0; t <= 9.0; t += 0.5) {
    monitor.begin(t, kPlace, 10.0, 3.0);
    monitor.update(true, kPlace, 3.0, 10.0);
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
      monitor.begin(t, kPlace, 10.0, 3.0);
      monitor.update(true, kPlace, 3.0, 10.0);
    }
    EXPECT_TRUE(monitor.stalled());
    monitor.begin(3.5, kPlace, 10.0, 2.5);
    return monitor;
  };
  ProgressMonitor nearer = stalled();
  nearer.update(true, kPlace + Eigen::Vector2d(0.3, 0.0), 2.5, 10.0);
  EXPECT_EQ(nearer.stalled_for(), 0.0);
  EXPECT_TRUE(nearer.stalled());
  // ... until it has got away from there.
  nearer.begin(4.0, kPlace, 10.0, 2.0);
  nearer.update(true, kPlace + Eigen::Vector2d(0.9, 0.0), 2.0, 10.0);
  EXPECT_TRUE(nearer.stalled());
  nearer.begin(4.5, kPlace, 10.0, 1.5);
  nearer.update(true, kPlace + Eigen::Vector2d(1.1, 0.0), 1.5, 10.0);
  EXPECT_FALSE(nearer.stalled());
  ProgressMonitor seen = stalled();
  seen.update(true, kPlace, 3.0, 10.2);
  EXPECT_FALSE(seen.stalled());
  ProgressMonitor other = stalled();
  other.update(false, kPlace, 3.0, 10.0);
  EXPECT_TRUE(other.stalled()) << "the clock runs on: targets that alternate are no progress";
  ProgressMonitor dropped = stalled();
  dropped.target_dropped();
  EXPECT_FALSE(dropped.stalled());
  ProgressMonitor none = stalled();
  none.no_target();
  EXPECT_FALSE(none.stalled());
  EXPECT_EQ(none.stalled_for(), 0.0);
}

// A door that noise opens and closes moves the cost-to-go up and down for ever.
TEST(ProgressMonitor, AFallOfTheCostToGoCountsOnlyIfTheRobotMoved) {
  ProgressMonitor stands({}), moves({});
  for (int n = 0; n <= 6; ++n) {
    const Eigen::Vector2d there = kPlace + Eigen::Vector2d(0.25 * n, 0.0);
    stands.begin(0.5 * n, kPlace, 10.0, 9.0);
    moves.begin(0.5 * n, there, 10.0, 9.0);
    stands.update(true, kPlace, n % 2 == 0 ? 9.0 : 6.0, 10.0);
    moves.update(true, there, 9.0 - 0.25 * n, 10.0);
  }
  EXPECT_TRUE(stands.stalled());
  EXPECT_EQ(moves.stalled_for(), 0.0);
}

// What another target costs, or the same one once a door has closed, is where progress begins anew.
TEST(ProgressMonitor, ProgressIsAgainstWhatTheWayCostsNow) {
  struct Row {
    bool same;            // target, at 1 s
    double then, at_end;  // [s] of cost-to-go at 1 s and 2 s; 8 at the beginning
    double stalled_for;
  };
  for (const Row& row :
       {Row{false, 3.0, 3.0, 2.0}, Row{false, 3.0, 2.0, 0.0}, Row{false, 30.0, 29.0, 0.0},
        Row{true, 30.0, 29.0, 0.0}, Row{true, 8.1, 7.9, 2.0}}) {
    ProgressMonitor monitor({});
    const auto step = [&](double t, double x, bool same, double cost) {
      const Eigen::Vector2d place(x, 0.0);
      monitor.begin(t, place, 10.0, cost);
      monitor.update(same, place, cost, 10.0);
    };
    step(0.0, 0.0, true, 8.0);
    step(1.0, 0.5, row.same, row.then);
    step(2.0, 1.0, true, row.at_end);
    EXPECT_EQ(monitor.stalled_for(), row.stalled_for) << row.then << " to " << row.at_end;
  }
  ProgressMonitor just_enough({.area = 0.5});
  just_enough.begin(0.0, kPlace, 10.0, 3.0);
  just_enough.begin(1.0, kPlace, 10.0, 3.0);
  just_enough.update(true, kPlace, 3.0, 10.5);
  EXPECT_EQ(just_enough.stalled_for(), 0.0);
}

TEST(ProgressMonitor, TimeWithSomethingElseToDoDoesNotCount) {
  ProgressMonitor monitor({});
  monitor.hold(5.0);
  monitor.begin(0.0, kPlace, 10.0, 3.0);
  monitor.update(true, kPlace, 3.0, 10.0);
  monitor.hold(20.0);
  monitor.begin(20.0, kPlace, 10.0, 3.0);
  monitor.update(true, kPlace, 3.0, 10.0);
  EXPECT_EQ(monitor.stalled_for(), 0.0);
  monitor.begin(22.0, kPlace, 10.0, 3.0);
  monitor.update(true, kPlace, 3.0, 10.0);
  EXPECT_EQ(monitor.stalled_for(), 2.0);
  // A clock that jumps back does not freeze it.
  monitor.begin(1.0, kPlace, 10.0, 3.0);
  monitor.update(true, kPlace, 3.0, 10.0);
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
