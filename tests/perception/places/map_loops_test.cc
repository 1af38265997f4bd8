// SPDX-License-Identifier: Apache-2.0
#include "perception/places/map_loops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/support/quantile.h"
#include "engine/support/stopwatch.h"
#include "perception/mapping/anchored_map.h"
#include "tests/perception/mapping/drawn_room.h"

namespace prospect::map_loops_test {
namespace {

/// A robot that goes round the room, whose odometry turns a little with each step.
struct Drifting {
  std::shared_ptr<OccupancyMapper> map = std::make_shared<OccupancyMapper>();
  AnchoredMap anchored{map, on_the_way(0)};
  MapLoops loops;
  Pose estimate = on_the_way(0);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<MapLoops::Followed> followed;
  std::vector<double> milliseconds, recomposing;  // of each piece of work
  std::mt19937_64 generator{7};

  void go(int steps, double turn) {
    for (int n = 1; n <= steps; ++n) {
      const Pose before = on_the_way(n - 1), now = on_the_way(n);
      const PlanarMove step = move_between(before, now);
      const PlanarMove drawn = move_between(before, estimate);
      Pose next = drawn(step(before));
      next.yaw += turn;
      const Eigen::Vector2d way = (next.position - estimate.position).head<2>();
      Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
      F(0, 2) = -way.y();
      F(1, 2) = way.x();
      covariance = F * covariance * F.transpose();
      covariance(2, 2) += turn * turn;
      covariance.diagonal().head<2>().array() += 1e-6;
      estimate = next;
      DepthScan scan = room_scan(now, 0.01, generator, 0.0, 80, 20);
      const PlanarMove wrong = move_between(now, estimate);
      scan.origin = wrong(scan.origin);
      for (Eigen::Vector3d& p : scan.hits) p = wrong(p);
      for (Eigen::Vector3d& p : scan.misses) p = wrong(p);
      if (n % 20 == 0) anchored.begin(estimate, covariance);
      anchored.note(estimate);
      map->insert(scan);
      const bool recomposes = anchored.follows();
      ProcessorStopwatch work;
      if (auto done = loops.go_on(anchored, 0.2 * n)) followed.push_back(std::move(*done));
      (recomposes ? recomposing : milliseconds).push_back(work.lap());
    }
  }
  /// Time to follow what is known.
  void rest(int pieces) {
    for (int n = 0; n < pieces; ++n) {
      if (auto done = loops.go_on(anchored, 1e3 + n)) followed.push_back(std::move(*done));
    }
  }
  double error(int n) const {
    return (loops.origin()(estimate).position - on_the_way(n).position).norm();
  }
};

TEST(MapLoops, TakesBackWhatOdometryHasDrifted) {
  Drifting robot;
  constexpr int kSteps = 420;
  robot.go(kSteps, 0.0012);
  robot.rest(100);
  const double without = (robot.estimate.position - on_the_way(kSteps).position).norm(),
               with = robot.error(kSteps);
  std::printf("%.3f m without, %.3f m with loops; %zu of %zu used, %zu corrections\n", without,
              with, robot.loops.used(), robot.loops.found(), robot.followed.size());
  for (const auto& [what, times] :
       {std::pair("recomposing", robot.recomposing), std::pair("else", robot.milliseconds)}) {
    std::printf("a piece of work, %s: %.2f ms median, %.2f at 99 %%, %.2f at most\n", what,
                quantile(times, 0.5), quantile(times, 0.99), quantile(times, 1.0));
  }
  EXPECT_GT(without, 0.25);
  EXPECT_LT(with, 0.2 * without);
  ASSERT_FALSE(robot.followed.empty());
  // What is told is what was done.
  PlanarMove all;
  for (const MapLoops::Followed& f : robot.followed) {
    EXPECT_EQ(f.correction.kind, CorrectionKind::kAnchors);
    all = all * planar_move(f.correction.T_new_old);
  }
  EXPECT_NEAR((all(robot.estimate).position - robot.loops.origin()(robot.estimate).position).norm(),
              0.0, 1e-9);
}

TEST(MapLoops, TheSameCallsMakeTheSameBits) {
  Drifting a, b;
  a.go(150, 0.0012);
  b.go(150, 0.0012);
  EXPECT_EQ(a.followed.size(), b.followed.size());
  EXPECT_EQ(a.loops.origin().shift, b.loops.origin().shift);
  EXPECT_EQ(a.loops.origin().yaw, b.loops.origin().yaw);
  EXPECT_EQ(a.map->voxels()->data(), b.map->voxels()->data());
}

TEST(MapLoops, AMapThatIsStraightStays) {
  Drifting robot;
  robot.go(300, 0.0);
  for (const MapLoops::Followed& f : robot.followed) {
    EXPECT_LT(f.correction.T_new_old.translation().norm(), 0.05);
  }
  EXPECT_LT(robot.error(300), 0.03);
}

}  // namespace
}  // namespace prospect::map_loops_test
