// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/depth_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/adapters/box_room.h"

namespace prospect::depth_camera_test {
namespace {

DepthCameraOptions noiseless() {
  DepthCameraOptions options;
  options.noise_constant = options.noise_quadratic = options.dropout = 0.0;
  return options;
}

// First solid voxel along a ray, by the entry distance into each solid voxel's box, over all
// voxels.
double brute_force_range(const World& world, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& d) {
  const GridFrame f = world.voxels.frame();
  const double r = f.resolution;
  double best = 1e9;
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = world.voxels.k0(); k < world.voxels.k0() + world.voxels.depth(); ++k) {
        if (!world.solid(i, j, k)) continue;
        double enter = 0.0, leave = 1e9;
        const int address[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          const double low = address[a] * r, high = (address[a] + 1) * r;
          if (std::abs(d[a]) < 1e-12) {
            if (from[a] < low || from[a] > high) enter = 1e9;
            continue;
          }
          const double t0 = (low - from[a]) / d[a], t1 = (high - from[a]) / d[a];
          enter = std::max(enter, std::min(t0, t1));
          leave = std::min(leave, std::max(t0, t1));
        }
        if (enter <= leave + 1e-12) best = std::min(best, enter);
      }
    }
  }
  return best;
}

TEST(DepthCamera, AgreesWithBruteForce) {
  World world = test::box_room(5.0, 4.0);
  test::fill(world, {3.6, 2.4, 0.0}, {3.9, 2.9, 1.1});
  test::fill(world, {1.2, 0.3, 0.3}, {1.5, 1.2, 0.6}, CellState::kUnknown);  // opaque as well
  DepthCameraOptions options = noiseless();
  options.columns = 16;
  options.rows = 12;
  options.footprint.max_range = 2.5;
  for (const double yaw : {0.2, 2.0, -2.2}) {
    DepthCamera camera(world, options, {}, 1);
    const Pose pose{{2.53, 1.97, 0.0}, yaw};
    const Eigen::Isometry3d T_WC = camera_pose(pose, camera.mount());
    const DepthScan scan = transform(camera.sense(pose), pose);
    ASSERT_LT((scan.origin - T_WC.translation()).norm(), 1e-12);
    std::size_t hit = 0, miss = 0;
    for (const Eigen::Vector3d& d_C : camera.directions()) {
      const Eigen::Vector3d d = T_WC.linear() * d_C;
      const double range = brute_force_range(world, T_WC.translation(), d);
      if (range < options.footprint.min_range) continue;
      if (range <= options.footprint.max_range) {
        ASSERT_LT(hit, scan.hits.size());
        EXPECT_NEAR((scan.hits[hit] - scan.origin).norm(), range, 1e-9);
        EXPECT_LT(((scan.hits[hit] - scan.origin).normalized() - d).norm(), 1e-9);
        ++hit;
      } else {
        ASSERT_LT(miss, scan.misses.size());
        EXPECT_LT(((scan.misses[miss] - scan.origin).normalized() - d).norm(), 1e-9);
        ++miss;
      }
    }
    EXPECT_EQ(hit, scan.hits.size());
    EXPECT_EQ(miss, scan.misses.size());
    EXPECT_GT(hit, 20U);
  }
}

TEST(DepthCamera, SurfacesCloserThanTheMinimumRangeSayNothing) {
  World world = test::box_room(5.0, 4.0);
  test::fill(world, {2.65, 0.0, 0.0}, {2.75, 4.0, 2.0});
  DepthCamera camera(world, noiseless(), {}, 1);
  const DepthScan scan = camera.sense({{2.55, 2.0, 0.0}, 0.0});  // a wall 5 cm ahead
  // Only rays far enough to the side meet it at the minimum range or farther: none of this
  // footprint.
  EXPECT_TRUE(scan.hits.empty());
  EXPECT_TRUE(scan.misses.empty());
  std::vector<CellState> seen(world.voxels.data().size(), CellState::kUnknown);
  camera.sense({{2.55, 2.0, 0.0}, 0.0}, &seen);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), CellState::kFree), 0);
}

TEST(DepthCamera, RangeNoiseGrowsWithTheSquareOfDepthAndDropsOut) {
  for (const double distance : {1.0, 3.5}) {
    const World world = test::box_room(2.0 * distance, 8.0, 4.0);
    DepthCameraOptions options;
    options.dropout = 0.1;
    DepthCamera camera(world, options, {}, 5);
    const Pose pose{{distance, 4.0, 0.0}, 0.0};
    double sum = 0.0, sum_squared = 0.0;
    int count = 0, rays = 0;
    for (int n = 0; n < 60; ++n) {
      const DepthScan scan = camera.sense(pose);
      rays += static_cast<int>(camera.directions().size());
      for (const auto& p : scan.hits) {
        // The middle of the far wall: the ray's length there is its depth within half a per cent.
        if (std::abs(p.y()) > 0.08 * distance || std::abs(p.z() - 0.45) > 0.08 * distance) continue;
        const double error = (p.x() - distance) / ((p - scan.origin).normalized().x());
        sum += error;
        sum_squared += error * error;
        ++count;
      }
      const double valid = static_cast<double>(scan.hits.size() + scan.misses.size());
      EXPECT_NEAR(valid / static_cast<double>(camera.directions().size()), 0.9, 0.02);
    }
    ASSERT_GT(count, 2000);
    const double expected = 0.0015 + 0.0016 * distance * distance;
    EXPECT_NEAR(sum / count, 0.0, 4.0 * expected / std::sqrt(count));
    EXPECT_NEAR(std::sqrt(sum_squared / count), expected, 0.06 * expected);
    EXPECT_GT(rays, 0);
  }
}

TEST(DepthCamera, NotesWhatValidRaysHaveSeen) {
  World world = test::box_room(5.0, 4.0);
  DepthCameraOptions options = noiseless();
  DepthCamera camera(world, options, {}, 1);
  std::vector<CellState> seen(world.voxels.data().size(), CellState::kUnknown);
  std::vector<std::uint32_t> fresh;
  const Pose pose{{2.5, 2.0, 0.0}, 0.0};
  camera.sense(pose, &seen, &fresh);
  std::size_t known = 0;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    if (seen[n] == CellState::kUnknown) continue;
    ++known;
    EXPECT_EQ(seen[n], world.voxels.data()[n]);  // the truth, never noise
  }
  EXPECT_EQ(known, fresh.size());
  EXPECT_EQ(seen[world.voxels.index(50, 20, 4)], CellState::kOccupied);
  EXPECT_EQ(seen[world.voxels.index(40, 20, 4)], CellState::kFree);
  EXPECT_EQ(seen[world.voxels.index(10, 20, 4)], CellState::kUnknown);  // behind
  fresh.clear();
  camera.sense(pose, &seen, &fresh);
  EXPECT_TRUE(fresh.empty());
  options.dropout = 1.0;
  DepthCamera blind(world, options, {}, 1);
  blind.sense({{2.5, 2.0, 0.0}, 3.14}, &seen, &fresh);
  EXPECT_TRUE(fresh.empty());
}

TEST(DepthCamera, SameSeedSameBitsAndOtherSeedOthers) {
  const World world = test::box_room(5.0, 4.0);
  DepthCamera a(world, {}, {}, 3), b(world, {}, {}, 3), c(world, {}, {}, 4);
  bool differs = false;
  for (int n = 0; n < 3; ++n) {
    const Pose pose{{2.5, 2.0, 0.0}, 0.3 * n};
    const DepthScan x = a.sense(pose), y = b.sense(pose), z = c.sense(pose);
    EXPECT_EQ(x.hits, y.hits);
    EXPECT_EQ(x.misses, y.misses);
    differs |= x.hits != z.hits;
  }
  EXPECT_TRUE(differs);
}

TEST(DepthCamera, ALidarSeesAllRoundAndNothingTwice) {
  const World world = test::box_room(5.0, 4.0);
  for (const double degrees : {200.0, 270.0, 360.0}) {
    for (const double vertical : {0.0, 0.5}) {
      DepthCameraOptions options = noiseless();
      options.footprint = {degrees * M_PI / 180.0, vertical, 0.1, 12.0};
      set_resolution(options);
      EXPECT_EQ(options.rows, vertical == 0.0 ? 1 : 32);
      EXPECT_NEAR(options.columns, 80 * options.footprint.horizontal_fov / 1.22, 0.5);
      DepthCamera camera(world, options, {}, 1);
      const Pose pose{{2.53, 1.97, 0.0}, 0.4};
      const DepthScan scan = camera.sense(pose);
      EXPECT_EQ(scan.hits.size(), camera.directions().size());
      double left = 0.0, right = 0.0;
      for (std::size_t n = 0; n < scan.hits.size(); ++n) {
        const Eigen::Vector3d to = scan.hits[n] - scan.origin;
        const double azimuth = std::atan2(to.y(), to.x());
        left = std::max(left, azimuth);
        right = std::min(right, azimuth);
        if (vertical == 0.0) {
          EXPECT_NEAR(to.z(), 0.0, 1e-12);
        }
        if (n % 37 != 0) continue;  // the slow ranges
        const Eigen::Isometry3d T_WC = camera_pose(pose, camera.mount());
        EXPECT_NEAR(
            to.norm(),
            brute_force_range(world, T_WC.translation(), T_WC.linear() * camera.directions()[n]),
            1e-9);
      }
      // The outermost rays are half a spacing within the sides; all round, a spacing apart.
      const double spacing = options.footprint.horizontal_fov / options.columns;
      EXPECT_NEAR(left - right, options.footprint.horizontal_fov - spacing, 1e-9);
    }
  }
}

TEST(DepthCamera, TheDefaultFootprintHasTheDefaultResolution) {
  DepthCameraOptions options;
  options.columns = options.rows = 1;
  set_resolution(options);
  EXPECT_EQ(options.columns, 80);
  EXPECT_EQ(options.rows, 60);
}

TEST(DepthCamera, RejectsOptionsOutOfRangeAndSurvivesPosesOutside) {
  const World world = test::box_room(2.0, 2.0);
  DepthCameraOptions options;
  options.rows = 0;
  EXPECT_THROW(DepthCamera(world, options, {}, 1), std::invalid_argument);
  options = {};
  options.footprint.max_range = 0.1;
  EXPECT_THROW(DepthCamera(world, options, {}, 1), std::invalid_argument);
  options = {};
  options.footprint.horizontal_fov = 6.3;
  EXPECT_THROW(DepthCamera(world, options, {}, 1), std::invalid_argument);
  options = {};
  options.dropout = 1.5;
  EXPECT_THROW(DepthCamera(world, options, {}, 1), std::invalid_argument);
  DepthCamera camera(world, {}, {}, 1);
  EXPECT_TRUE(camera.sense({{50.0, 0.0, 0.0}, 0.0}).hits.empty());
  EXPECT_TRUE(camera.sense({{-0.05, 1.0, 0.0}, 0.0}).hits.empty());  // inside the wall
}

}  // namespace
}  // namespace prospect::depth_camera_test
