// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/mover_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace prospect::mover_tracker_test {
namespace {

constexpr double kPeriod = 0.1;  // [s] between scans

/// A hall with a wall at x = 4 m, looked at by a lidar of three planes at the origin.
class Hall {
 public:
  Hall() : Hall(MoverTrackerOptions()) {}
  explicit Hall(const MoverTrackerOptions& options) : tracker_(options) {
    OccupancyMapperOptions mapping;
    mapping.max_range = 6.0;
    mapping.slice = HeightSlice{0.1, 0.5, {}, 0.05};
    map_ = OccupancyMapper(mapping);
    for (int n = 0; n < 5; ++n) scan({});
  }

  /// One scan with upright cylinders in the room, `drift` [m] off in x, from the angle `from` on
  /// [rad].
  void scan(const std::vector<Disc>& things, double drift = 0.0, double from = -1.5) {
    DepthScan s;
    s.origin = {drift, 0.0, 0.35};
    for (int k = -150; k <= 150; ++k) {
      const double angle = 0.01 * k;
      if (angle < from) continue;
      const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
      double far = 4.0 / along.x();
      for (const Disc& d : things) {
        const double ahead = along.dot(d.center);
        const double aside2 = d.center.squaredNorm() - ahead * ahead;
        const double depth2 = d.radius * d.radius - aside2;
        if (ahead > 0.0 && depth2 > 0.0) far = std::min(far, ahead - std::sqrt(depth2));
      }
      for (const double slope : {-0.05, 0.01, 0.15}) {
        const Eigen::Vector3d p(far * along.x() + drift, far * along.y(), 0.35 + slope * far);
        (far < 5.5 ? s.hits : s.misses).push_back(p);
      }
    }
    tracker_.look(time_, map_, s);
    map_.insert(s);
    passing_ = s.passing.size();
    time_ += kPeriod;
  }
  double now() const { return time_ - kPeriod; }
  std::optional<Mover> one() const {
    const auto known = tracker_.movers(now());
    if (known == nullptr || known->all.size() != 1) return std::nullopt;
    return known->all.front();
  }
  /// Occupied cells within `radius` of a place.
  int occupied(const Eigen::Vector2d& at, double radius) {
    const auto ground = map_.ground();
    int count = 0;
    for (int n = 0; n < ground->frame().size(); ++n) {
      const Cell c = ground->frame().at(n);
      count += ground->state(c) == CellState::kOccupied &&
               (ground->frame().center(c) - at).norm() < radius;
    }
    return count;
  }
  MoverTracker tracker_;
  OccupancyMapper map_;
  std::size_t passing_ = 0;
  double time_ = 0.0;
};

TEST(MoverTracker, WhoWalksLeavesNoTrailAndIsPredicted) {
  Hall hall;
  const Eigen::Vector2d velocity(0.0, 1.0);
  Eigen::Vector2d at(2.0, -1.5);
  for (int n = 0; n < 25; ++n, at += kPeriod * velocity) {
    hall.scan({{at, 0.2}});
    if (n < 6) continue;  // it has to move first
    EXPECT_GT(hall.passing_, 0u) << n;
    const auto mover = hall.one();
    ASSERT_TRUE(mover) << n;
    // Its front is seen.
    EXPECT_LT((mover->position - at).norm(), 0.3) << n;
    if (n < 12) continue;
    EXPECT_NEAR(mover->velocity.x(), 0.0, 0.25) << n;
    EXPECT_NEAR(mover->velocity.y(), 1.0, 0.25) << n;
    const Eigen::Vector2d in_a_second = at + velocity;
    EXPECT_LT((mover->at(1.0) - in_a_second).norm(), mover->reach(1.0));
  }
  EXPECT_EQ(hall.occupied({2.0, 0.0}, 1.7), 0);
  hall.scan({});
  EXPECT_EQ(hall.tracker_.movers(hall.now()), nullptr) << "a ray passes through";
  EXPECT_EQ(hall.occupied({2.0, 0.0}, 1.7), 0);
}

TEST(MoverTracker, WhoIsNotSeenAnyMoreHasNotGone) {
  MoverTrackerOptions options;
  options.keep = 5.0;
  constexpr double kElsewhere = 0.9;  // [rad]: where they are not looked for
  for (const bool stops : {true, false}) {
    Hall hall(options);
    Eigen::Vector2d at(2.0, -1.5);
    for (int n = 0; n < 15; ++n, at.y() += 0.1) hall.scan({{at, 0.2}});
    for (int n = 0; stops && n < 12; ++n) hall.scan({{at, 0.2}});
    for (int n = 0; n < 19; ++n) {
      hall.scan({}, 0.0, kElsewhere);
      const auto mover = hall.one();
      ASSERT_TRUE(mover) << "out of view, at " << n;
      const Eigen::Vector2d expected = stops ? at : at + Eigen::Vector2d(0.0, 0.1 * n);
      EXPECT_LT((mover->position - expected).norm(), 0.5) << n;
    }
    for (int n = 0; n < 3; ++n) hall.scan({}, 0.0, kElsewhere);
    EXPECT_EQ(hall.one().has_value(), stops) << "who walks may be anywhere by now";
    if (!stops) continue;
    for (int n = 0; n < 26; ++n) hall.scan({}, 0.0, kElsewhere);
    EXPECT_TRUE(hall.one());
    hall.scan({});
    EXPECT_FALSE(hall.one()) << "a ray passes through";
    EXPECT_EQ(hall.occupied({2.0, 0.0}, 1.7), 0);
  }
}

TEST(MoverTracker, WhatStandsIsOfTheBuildingUntilItGoes) {
  Hall hall;
  const Disc post{{2.0, 0.5}, 0.15};
  for (int n = 0; n < 30; ++n) {
    hall.scan({post});
    EXPECT_EQ(hall.passing_, 0u) << n;
    EXPECT_FALSE(hall.one()) << n;
    EXPECT_TRUE(n < 4 || hall.occupied(post.center, 0.4) > 0) << n;
  }
  for (int n = 0; n < 15; ++n) hall.scan({});
  EXPECT_EQ(hall.occupied(post.center, 0.4), 0) << "rays clear it";
}

TEST(MoverTracker, WhoHasWalkedAndStandsIsGoneRoundLater) {
  Hall hall;
  Eigen::Vector2d at(2.0, -1.0);
  for (int n = 0; n < 10; ++n, at.y() += 0.1) hall.scan({{at, 0.2}});
  for (int n = 0; n < 20; ++n) {
    hall.scan({{at, 0.2}});
    EXPECT_EQ(hall.occupied(at, 0.4), 0) << "somebody who rests for two seconds, at " << n;
  }
  for (int n = 0; n < 20; ++n) hall.scan({{at, 0.2}});
  EXPECT_GT(hall.occupied(at, 0.4), 0);
  // And on: nothing stays where it stood.
  for (int n = 0; n < 20; ++n, at.y() += 0.1) hall.scan({{at, 0.2}});
  for (int n = 0; n < 15; ++n) hall.scan({});
  EXPECT_EQ(hall.occupied({2.0, 0.5}, 1.7), 0);
}

TEST(MoverTracker, TheBuildingDoesNotMove) {
  // Neither by a pose that is off by a voxel, nor where it was not seen before, nor in large.
  Hall hall;
  for (int n = 0; n < 10; ++n) hall.scan({}, -0.08);
  EXPECT_EQ(hall.passing_, 0u);
  EXPECT_EQ(hall.tracker_.movers(hall.now()), nullptr);

  MoverTracker fresh;
  OccupancyMapper map;
  DepthScan first;
  first.origin = {0.0, 0.0, 0.3};
  for (int k = -20; k <= 20; ++k) first.hits.emplace_back(2.0, 0.05 * k, 0.3);
  fresh.look(0.0, map, first);
  EXPECT_TRUE(first.passing.empty());

  Hall wide;
  for (int n = 0; n < 5; ++n) wide.scan({{{2.5, 0.0}, 1.0}});
  EXPECT_EQ(wide.passing_, 0u) << "two metres across";
}

TEST(MoverTracker, TwoWhoCrossAreTwo) {
  Hall hall;
  int two = 0;
  for (int n = 0; n < 30; ++n) {
    hall.scan({{{1.5, -1.5 + 0.1 * n}, 0.2}, {{2.8, 1.5 - 0.1 * n}, 0.2}});
    if (n < 5) continue;  // they have to move first
    const auto known = hall.tracker_.movers(hall.now());
    ASSERT_NE(known, nullptr);
    two += known->all.size() == 2;
  }
  // One hides the other for a while, who is predicted on.
  EXPECT_GT(two, 15);
}

TEST(MoverTracker, IsSilentWhereItIsSwitchedOff) {
  MoverTrackerOptions off;
  off.enabled = false;
  Hall hall(off);
  for (int n = 0; n < 10; ++n) hall.scan({{{2.0, -0.5 + 0.1 * n}, 0.2}});
  EXPECT_EQ(hall.passing_, 0u);
  EXPECT_EQ(hall.tracker_.movers(hall.now()), nullptr);
  EXPECT_GT(hall.occupied({2.0, 0.0}, 1.7), 0);
}

TEST(MoverTracker, WhatIsNotFiniteSaysNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Hall hall;
  for (const double wrong : {kNan, kInfinite, -kInfinite, 1e300}) {
    DepthScan s;
    s.origin = {0.0, 0.0, 0.3};
    s.hits = {{wrong, 1.0, 0.3}, {1.0, wrong, 0.3}, {1.0, 1.0, wrong}};
    hall.tracker_.look(hall.time_, hall.map_, s);
    EXPECT_TRUE(s.passing.empty()) << wrong;
    hall.tracker_.look(wrong, hall.map_, s);
  }
  MoverTrackerOptions options;
  options.spread = kNan;
  EXPECT_THROW(MoverTracker{options}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::mover_tracker_test
