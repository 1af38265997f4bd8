// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/scan_mapper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace prospect::scan_mapper_test {
namespace {

Eigen::Isometry3d at(double x, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, 0.025, z;
  return T;
}

/// A wall across x = 1.52 m seen from the origin, by `n` points at the height of the lidar.
DepthScan wall(int n = 40, double x = 1.52, double z = 0.0) {
  DepthScan scan;
  for (int i = 0; i < n; ++i) scan.hits.emplace_back(x, -1.0 + 2.0 * i / n, z);
  return scan;
}

ScanMapperOptions options() {
  ScanMapperOptions o;
  o.map.resolution = 0.05;
  return o;
}

TEST(ScanMapper, ObstaclesFloorAndWhatIsBelow) {
  ScanMapper mapper(options());
  DepthScan scan = wall();
  scan.hits.emplace_back(1.03, 0.30, -0.435);  // 0.01 m below the floor: floor
  scan.hits.emplace_back(1.13, 0.30, -0.525);  // a drop
  scan.hits.emplace_back(9.0, 0.0, 0.0);       // beyond the range
  scan.misses.emplace_back(0.05, 4.0, 0.0);
  scan.hits.emplace_back(std::nan(""), 0.0, 0.0);
  const MappedFrame frame = mapper.process(1.0, scan, at(0.0, 0.425));
  ASSERT_EQ(frame.state, Mapping::kOk) << frame.reason;
  EXPECT_EQ(frame.floor, 1);
  EXPECT_EQ(frame.hits, 40);
  EXPECT_EQ(frame.misses, 2);
  const auto voxels = mapper.map().voxels();
  EXPECT_EQ(voxels->state(30, 0, 8), CellState::kOccupied);
  EXPECT_EQ(voxels->state(20, 0, 8), CellState::kFree);
  EXPECT_EQ(voxels->state(20, 6, -1), CellState::kOccupied) << "the floor is below z = 0";
  EXPECT_EQ(frame.below, 1);
  EXPECT_EQ(voxels->state(22, 6, -2), CellState::kFree);
  EXPECT_EQ(voxels->state(0, 40, 8), CellState::kFree) << "a ray that met nothing";
}

TEST(ScanMapper, ManyPointsInACubeCountOnce) {
  ScanMapper few(options()), many(options());
  DepthScan dense = wall(40);
  for (int i = 0; i < 2000; ++i) dense.hits.push_back(dense.hits[static_cast<std::size_t>(i % 40)]);
  const MappedFrame a = few.process(1.0, wall(40), at(0.0, 0.425));
  const MappedFrame b = many.process(1.0, dense, at(0.0, 0.425));
  EXPECT_EQ(a.hits, b.hits);
  EXPECT_EQ(few.map().voxels()->data(), many.map().voxels()->data());
}

TEST(ScanMapper, WhatIsRejectedLeavesTheMapAsItWas) {
  ScanMapper mapper(options());
  ASSERT_EQ(mapper.process(1.0, wall(), at(0.0, 0.425)).state, Mapping::kOk);
  const auto before = mapper.map().voxels();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto reason = [&](double stamp, const DepthScan& scan, const Eigen::Isometry3d& T) {
    const MappedFrame frame = mapper.process(stamp, scan, T);
    EXPECT_EQ(frame.state, Mapping::kRejected);
    EXPECT_EQ(frame.hits + frame.floor + frame.misses, 0);
    EXPECT_EQ(frame.T_WC.translation(), at(0.0, 0.425).translation());
    return frame.reason;
  };
  EXPECT_EQ(reason(nan, wall(), at(0.0, 0.425)), "the time is not a number");
  EXPECT_EQ(reason(0.9, wall(), at(0.0, 0.425)), "the time does not increase");
  EXPECT_EQ(reason(1.1, wall(), at(3.0, 0.425)), "the pose jumps");
  EXPECT_EQ(reason(1.2, wall(), at(nan, 0.425)), "the pose is no rotation and translation");
  EXPECT_EQ(reason(1.3, wall(), at(1e7, 0.425)), "the pose is outside of what a map can hold");
  EXPECT_EQ(reason(1.4, DepthScan(), at(0.0, 0.425)), "the scan has no valid range");
  EXPECT_EQ(reason(1.5, wall(40, 1.5, -1.0), at(0.0, 0.425)), "too much lies below the floor");
  ASSERT_NE(mapper.process(1.6, wall(), at(0.0, 0.425)).state, Mapping::kRejected);
  EXPECT_EQ(reason(1.7, wall(), at(0.2, 0.425)), "the scan is frozen");
  ASSERT_EQ(mapper.process(1.8, wall(40, 1.32), at(0.2, 0.425)).state, Mapping::kOk);
  EXPECT_EQ(before->state(30, 0, 8), CellState::kOccupied);
}

// However slowly: between two scans it never moves by much.
TEST(ScanMapper, TheSameScanIsOldOnlyIfTheLidarHasMoved) {
  ScanMapper stands(options()), moves(options());
  for (int k = 0; k < 40; ++k) {
    const double t = 0.1 * k;
    EXPECT_EQ(stands.process(t, wall(), at(0.0, 0.425)).reason, "") << t;
    const std::string reason = moves.process(t, wall(), at(0.05 * t, 0.425)).reason;
    if (t < 0.35 || t > 0.45) {
      EXPECT_EQ(reason, t < 0.35 ? "" : "the scan is frozen") << t;
    }
  }
}

TEST(ScanMapper, OptionsOutOfRangeAreRefused) {
  ScanMapperOptions bad = options();
  bad.point_spacing = 0.0;
  EXPECT_THROW(ScanMapper{bad}, std::invalid_argument);
  bad = options();
  bad.max_speed = std::nan("");
  EXPECT_THROW(ScanMapper{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::scan_mapper_test
