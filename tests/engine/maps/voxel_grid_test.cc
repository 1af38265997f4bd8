// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/voxel_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/support/stopwatch.h"
#include "tests/engine/view_worlds.h"

namespace prospect::voxel_grid_test {
namespace {

using test::uniform;

/// The obvious way: clips the segment against every voxel of a block around it.
VoxelGrid::Ray slow_cast(const VoxelGrid& grid, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to, double trim) {
  VoxelGrid::Ray ray;
  const double distance = (to - from).norm();
  const double end = distance - trim;
  if (!(end > 0.0)) return ray;
  const Eigen::Vector3d direction = (to - from) / distance;
  const double r = grid.resolution();
  const Eigen::Vector3i lo = grid.voxel(from.cwiseMin(to)), hi = grid.voxel(from.cwiseMax(to));
  const Eigen::Vector3i start = grid.voxel(from);
  struct Piece {
    double enter, leave;
    CellState state;
  };
  std::vector<Piece> pieces;
  for (int i = lo.x(); i <= hi.x(); ++i) {
    for (int j = lo.y(); j <= hi.y(); ++j) {
      for (int k = lo.z(); k <= hi.z(); ++k) {
        if (Eigen::Vector3i(i, j, k) == start) continue;
        double enter = 0.0, leave = end;
        const int v[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          if (direction[a] == 0.0) {
            if (from[a] < v[a] * r || from[a] >= (v[a] + 1) * r) leave = -1.0;
            continue;
          }
          const double t0 = (v[a] * r - from[a]) / direction[a];
          const double t1 = ((v[a] + 1) * r - from[a]) / direction[a];
          enter = std::max(enter, std::min(t0, t1));
          leave = std::min(leave, std::max(t0, t1));
        }
        if (leave - enter > 1e-9) pieces.push_back({enter, leave, grid.state(i, j, k)});
      }
    }
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece& a, const Piece& b) { return a.enter < b.enter; });
  for (const Piece& p : pieces) {
    if (p.state == CellState::kOccupied) {
      ray.blocked = true;
      ray.length = p.enter;
      return ray;
    }
    if (p.state == CellState::kUnknown) ray.unknown_length += p.leave - p.enter;
  }
  ray.length = end;
  return ray;
}

TEST(VoxelGridCast, AgreesWithClippingEveryVoxel) {
  std::mt19937_64 random(3);
  const VoxelGrid grid = test::hall(random, true);
  int blocked = 0, through_unknown = 0;
  for (int n = 0; n < 400; ++n) {
    const auto point = [&] {
      return Eigen::Vector3d(uniform(random, 0, 9), uniform(random, -3, 3),
                             uniform(random, -0.3, 3));
    };
    const Eigen::Vector3d from = point();
    Eigen::Vector3d to = point();
    if (n % 5 == 0) to.z() = from.z();
    if (n % 7 == 0) to.y() = from.y();
    const double trim = n % 3 ? 0.15 : 0.0;
    const VoxelGrid::Ray fast = grid.cast(from, to, trim), slow = slow_cast(grid, from, to, trim);
    ASSERT_EQ(fast.blocked, slow.blocked) << n;
    EXPECT_NEAR(fast.length, slow.length, 1e-7) << n;
    EXPECT_NEAR(fast.unknown_length, slow.unknown_length, 1e-7) << n;
    blocked += fast.blocked;
    through_unknown += fast.unknown_length > 0.0;
  }
  EXPECT_GT(blocked, 50);
  EXPECT_GT(through_unknown, 50);
}

// A ray from far off is one from near by, and as much longer; it costs what the near one costs: one
// of 1000 km took 0.1 s.
TEST(VoxelGridCast, WhatLiesBeyondTheBlockIsALength) {
  std::mt19937_64 random(5);
  const VoxelGrid grid = test::hall(random, true);
  constexpr double kFar = 1e5;                // [m]
  const double first = 0.1 * std::sqrt(3.0);  // [m] of the voxel that is not counted, at most
  std::vector<Eigen::Vector3d> starts[2];     // near, far
  std::vector<Eigen::Vector3d> ends;
  int blocked = 0, missed = 0;
  for (int n = 0; n < 4000; ++n) {
    const double angle = uniform(random, -M_PI, M_PI);
    const Eigen::Vector3d near(30.0 * std::cos(angle), 30.0 * std::sin(angle),
                               n % 2 ? uniform(random, -3, 6) : 1.05);
    Eigen::Vector3d to(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, 0, 2));
    if (n % 2 == 0) to.z() = near.z();
    if (n % 3 == 0) to += 1.5 * (to - near);
    if (n % 5 == 0) to.head<2>() = near.head<2>() + Eigen::Vector2d(-near.y(), near.x());
    const Eigen::Vector3d far = near + kFar * (near - to).normalized();
    const VoxelGrid::Ray a = grid.cast(near, to, 0.15), b = grid.cast(far, to, 0.15);
    ASSERT_EQ(a.blocked, b.blocked) << n;
    EXPECT_NEAR(b.length, a.length + kFar, 1e-6) << n;
    EXPECT_NEAR(b.unknown_length, a.unknown_length + kFar, first) << n;
    const VoxelGrid::Ray back = grid.cast(to, far, 0.0);
    EXPECT_EQ(grid.cast(to, near, 0.0).blocked, back.blocked) << n;
    blocked += b.blocked;
    missed += b.unknown_length > (far - to).norm() - 0.15 - first;
    starts[0].push_back(near);
    starts[1].push_back(far);
    ends.push_back(to);
  }
  EXPECT_GT(blocked, 500);
  EXPECT_GT(missed, 500);
  double took[2];
  for (const int which : {0, 1}) {
    ProcessorStopwatch watch;
    for (std::size_t n = 0; n < ends.size(); ++n) {
      EXPECT_TRUE(grid.cast(starts[which][n], ends[n]).length > 0.0);
    }
    took[which] = watch.lap();
  }
  EXPECT_LT(took[1], 20.0 * took[0]);
}

TEST(VoxelGridCast, ManyEqualsOneByOneToTheLastBit) {
  std::mt19937_64 random(4);
  const VoxelGrid grid = test::hall(random, true);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (int n = 0; n < 300; ++n) {
    // Inside the grid mostly; also beyond it, above it, on voxel faces, at its very corner, far
    // away.
    Eigen::Vector3d from(uniform(random, -9, 9), uniform(random, -9, 9),
                         uniform(random, -0.3, 2.8));
    if (n % 10 == 0) from = from.array().round();
    if (n % 37 == 0) from.x() = kNaN;
    std::vector<Eigen::Vector3d> to;
    const int count = n % 23;
    for (int i = 0; i < count; ++i) {
      to.emplace_back(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -0.3, 2.8));
      if (i % 5 == 1) to.back().z() = from.z();
      if (i % 5 == 2) to.back() = to.back().array().round();
      if (i == 3) to.back() = from;
      if (i == 4) to.back() = {8.0 - 1e-9, 8.0 - 1e-9, 2.5 - 1e-9};
      if (i == 6) to.back().y() = kNaN;
      if (i == 7) to.back() *= 1e9;
      if (i == 8) to.back().z() = std::numeric_limits<double>::infinity();
    }
    std::vector<VoxelGrid::Ray> rays(to.size());
    grid.cast_many(from, to.data(), count, 0.15, rays.data());
    for (int i = 0; i < count; ++i) {
      const auto m = static_cast<std::size_t>(i);
      const VoxelGrid::Ray one = grid.cast(from, to[m], 0.15);
      ASSERT_EQ(rays[m].blocked, one.blocked) << n << " " << i;
      ASSERT_EQ(rays[m].length, one.length) << n << " " << i;
      ASSERT_EQ(rays[m].unknown_length, one.unknown_length) << n << " " << i;
      ASSERT_TRUE(std::isfinite(one.length) && one.unknown_length >= 0.0);
    }
  }
}

TEST(VoxelGrid, GrowsWithoutLosingWhatItHolds) {
  VoxelGrid grid(GridFrame{0.1, 0, 0, 4, 4}, 0.0, 0.4);
  grid.set(1, 2, 3, CellState::kOccupied);
  grid.set(-50, 200, 0, CellState::kFree);
  grid.set(0, 0, 9, CellState::kFree);  // above: ignored
  EXPECT_EQ(grid.state(1, 2, 3), CellState::kOccupied);
  EXPECT_EQ(grid.state(-50, 200, 0), CellState::kFree);
  EXPECT_EQ(grid.state(0, 0, 9), CellState::kUnknown);
  int known = 0;
  for (const CellState s : grid.data()) known += s != CellState::kUnknown;
  EXPECT_EQ(known, 2);
}

}  // namespace
}  // namespace prospect::voxel_grid_test
