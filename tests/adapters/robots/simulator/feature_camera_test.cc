// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/feature_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>

#include "adapters/robots/simulator/depth_camera.h"
#include "tests/adapters/box_room.h"

namespace prospect::feature_camera_test {
namespace {

auto uniform_density(double d) {
  return [d](int, int, int) { return d; };
}

TEST(FeatureField, FeaturesLieOnExposedFacesWithTheGivenDensity) {
  World world = test::box_room(4.0, 3.0, 2.0);
  test::fill(world, {1.0, 1.0, 0.0}, {1.4, 1.3, 0.5});
  const FeatureField field(world, uniform_density(40.0), 1);
  const double r = 0.1;
  // Room: 2 (4 x 3 + 4 x 2 + 3 x 2); the box of 0.4 x 0.3 x 0.5 adds its four sides (its top
  // replaces the floor below it).
  const double area = 2.0 * (12.0 + 8.0 + 6.0) + 2.0 * (0.4 + 0.3) * 0.5;
  const double n = static_cast<double>(field.features().size());
  EXPECT_NEAR(n, 40.0 * area, 4.0 * std::sqrt(40.0 * area));
  for (const Feature& f : field.features()) {
    const Eigen::Vector3d inward = (f.position - 0.5 * r * f.normal) / r;
    const Eigen::Vector3d outward = (f.position + 0.5 * r * f.normal) / r;
    const auto state = [&](const Eigen::Vector3d& p) {
      return world.voxels.state(static_cast<int>(std::floor(p.x())),
                                static_cast<int>(std::floor(p.y())),
                                static_cast<int>(std::floor(p.z())));
    };
    EXPECT_EQ(state(inward), CellState::kOccupied);
    EXPECT_EQ(state(outward), CellState::kFree);
    EXPECT_DOUBLE_EQ(f.normal.norm(), 1.0);
  }
  EXPECT_TRUE(FeatureField(world, uniform_density(0.0), 1).features().empty());
}

TEST(FeatureField, NearVisitsEverythingInRangeOnce) {
  const World world = test::box_room(4.0, 3.0, 2.0);
  const FeatureField field(world, uniform_density(10.0), 1);
  for (const Eigen::Vector2d& at :
       {Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(-3.0, 2.0), Eigen::Vector2d(3.99, 0.01)}) {
    std::vector<std::uint32_t> found;
    field.near(at.x(), at.y(), 1.3, [&](std::uint32_t n) { found.push_back(n); });
    const std::set<std::uint32_t> unique(found.begin(), found.end());
    EXPECT_EQ(unique.size(), found.size());
    for (std::uint32_t n = 0; n < field.features().size(); ++n) {
      if ((field.features()[n].position.head<2>() - at).norm() <= 1.3) {
        EXPECT_TRUE(unique.count(n));
      }
    }
  }
}

// All conditions from their definitions, with occlusion by dense sampling of the sight line.
bool obviously_visible(const World& world, const Feature& f, const FeatureCameraOptions& o,
                       const Pose& pose, const CameraMount& mount, bool* marginal) {
  const Eigen::Isometry3d T_WC = camera_pose(pose, mount);
  const Eigen::Vector3d Y = T_WC.inverse() * f.position;
  const Eigen::Vector3d eye = T_WC.translation();
  *marginal = false;
  if (Y.z() < o.min_depth || Y.z() > o.max_depth) return false;
  const Eigen::Vector2d left = o.stereo.left.project(Y);
  const Eigen::Vector2d right =
      o.stereo.left.project(Y - Eigen::Vector3d(o.stereo.baseline, 0.0, 0.0));
  for (const Eigen::Vector2d& p : {left, right}) {
    if (p.x() < o.border || p.x() > o.stereo.left.width - o.border || p.y() < o.border ||
        p.y() > o.stereo.left.height - o.border) {
      return false;
    }
  }
  const double angle =
      std::acos(std::clamp((eye - f.position).normalized().dot(f.normal), -1.0, 1.0));
  if (angle > o.max_view_angle) return false;
  if (o.size * o.stereo.left.fx * std::cos(angle) / Y.z() < o.min_pixels) return false;
  const Eigen::Vector3d target = f.position + 1e-3 * f.normal;
  const int samples = 4000;
  int solid = 0;
  for (int n = 1; n < samples; ++n) {
    const Eigen::Vector3d p = eye + (target - eye) * (static_cast<double>(n) / samples);
    const Eigen::Vector3i v = world.voxels.voxel(p);
    solid += world.solid(v.x(), v.y(), v.z());
  }
  *marginal = solid > 0 && solid < 4;  // grazes an edge
  return solid == 0;
}

TEST(FeatureCamera, VisibilityAgreesWithItsDefinition) {
  World world = test::box_room(6.0, 5.0, 2.2);
  test::fill(world, {3.0, 1.0, 0.0}, {3.3, 2.6, 1.2});
  test::fill(world, {1.5, 3.4, 0.0}, {2.4, 3.6, 0.7});
  test::fill(world, {4.4, 3.0, 0.5}, {4.7, 3.3, 2.2}, CellState::kUnknown);
  const FeatureField field(world, uniform_density(12.0), 2);
  FeatureCameraOptions options;
  options.max_depth = 3.5;
  const CameraMount mount;
  const FeatureCamera camera(world, field, options, mount, 3);
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int total = 0, disagree = 0, occluded_away = 0;
  for (int n = 0; n < 60; ++n) {
    const Pose pose{{0.3 + 2.5 * u(generator), 0.3 + 2.9 * u(generator), 0.0}, 6.3 * u(generator)};
    const std::vector<std::uint32_t> visible = camera.visible(pose);
    EXPECT_TRUE(std::is_sorted(visible.begin(), visible.end()));
    for (std::uint32_t f = 0; f < field.features().size(); ++f) {
      bool marginal = false;
      const bool expected =
          obviously_visible(world, field.features()[f], options, pose, mount, &marginal);
      const bool got = std::binary_search(visible.begin(), visible.end(), f);
      total += expected;
      occluded_away += !expected && !got;
      // Sampling misses edges cut by less than a sample's spacing, in one direction only.
      if (got != expected && !marginal) {
        EXPECT_TRUE(expected) << "seen through a wall";
        ++disagree;
      }
    }
  }
  EXPECT_GT(total, 1500);
  EXPECT_LT(disagree, total / 300);
  EXPECT_GT(occluded_away, total);
}

TEST(FeatureCamera, TracksOneACellAndPrefersWhatItTracksAlready) {
  const World world = test::box_room(4.0, 4.0, 2.0);
  const FeatureField field(world, uniform_density(120.0), 1);
  FeatureCameraOptions options;
  options.cells = 150;
  FeatureCamera camera(world, field, options, {}, 2);
  int visible = 0;
  Pose pose{{1.5, 2.0, 0.0}, 0.1};
  const auto first = camera.observe(pose, &visible);
  EXPECT_EQ(visible, static_cast<int>(camera.visible(pose).size()));
  EXPECT_GT(visible, 200);
  EXPECT_GE(first.size(), 50U);
  const PinholeCamera& c = options.stereo.left;
  const double cell = std::sqrt(c.width * c.height / options.cells);
  std::set<std::pair<int, int>> cells;
  for (std::size_t n = 0; n < first.size(); ++n) {
    const Eigen::Vector2d p = c.project(first[n].true_point);
    EXPECT_TRUE(cells.emplace(std::floor(p.x() / cell), std::floor(p.y() / cell)).second);
    for (std::size_t m = 0; m < n; ++m) {
      EXPECT_GE((p - c.project(first[m].true_point)).norm(), 0.5 * cell);
    }
  }
  const auto again = camera.observe(pose);
  ASSERT_EQ(again.size(), first.size());
  for (std::size_t n = 0; n < first.size(); ++n) EXPECT_EQ(first[n].feature, again[n].feature);
  pose.yaw += 0.02;
  const auto moved = camera.observe(pose);
  int kept = 0;
  for (const auto& o : moved) {
    kept += std::any_of(first.begin(), first.end(),
                        [&](const auto& p) { return p.feature == o.feature; });
  }
  EXPECT_GT(kept, static_cast<int>(first.size()) * 3 / 4);
}

TEST(FeatureCamera, MeasurementNoiseHasTheStatedDeviation) {
  const World world = test::box_room(5.0, 4.0, 2.0);
  const FeatureField field(world, uniform_density(20.0), 1);
  const FeatureCameraOptions options;
  FeatureCamera camera(world, field, options, {}, 2);
  const Pose pose{{2.5, 2.0, 0.0}, 0.4};
  double su = 0.0, sv = 0.0, sd = 0.0;
  int count = 0;
  for (int n = 0; n < 60; ++n) {
    for (const auto& o : camera.observe(pose)) {
      const Eigen::Vector2d p = options.stereo.left.project(o.true_point);
      const double d = options.stereo.left.fx * options.stereo.baseline / o.true_point.z();
      EXPECT_GT(o.disparity, 0.0);
      su += std::pow(o.u - p.x(), 2);
      sv += std::pow(o.v - p.y(), 2);
      sd += std::pow(o.disparity - d, 2);
      ++count;
    }
  }
  ASSERT_GT(count, 3000);
  EXPECT_NEAR(std::sqrt(su / count), options.stereo.sigma_u, 0.03);
  EXPECT_NEAR(std::sqrt(sv / count), options.stereo.sigma_v, 0.03);
  EXPECT_NEAR(std::sqrt(sd / count), options.stereo.sigma_d, 0.02);
}

TEST(FeatureCamera, SameSeedSameBits) {
  const World world = test::box_room(5.0, 4.0, 2.0);
  const FeatureField field(world, uniform_density(20.0), 1), twin(world, uniform_density(20.0), 1);
  FeatureCamera a(world, field, {}, {}, 9), b(world, twin, {}, {}, 9);
  for (int n = 0; n < 4; ++n) {
    const Pose pose{{2.5, 2.0, 0.0}, 0.3 * n};
    const auto x = a.observe(pose), y = b.observe(pose);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t m = 0; m < x.size(); ++m) {
      EXPECT_EQ(x[m].feature, y[m].feature);
      EXPECT_EQ(x[m].u, y[m].u);
      EXPECT_EQ(x[m].disparity, y[m].disparity);
    }
  }
}

TEST(FeatureCamera, RejectsOptionsOutOfRange) {
  const World world = test::box_room(2.0, 2.0);
  const FeatureField field(world, uniform_density(1.0), 1);
  FeatureCameraOptions options;
  options.max_depth = 0.1;
  EXPECT_THROW(FeatureCamera(world, field, options, {}, 1), std::invalid_argument);
  options = {};
  options.stereo.baseline = -0.1;
  EXPECT_THROW(FeatureCamera(world, field, options, {}, 1), std::invalid_argument);
  options = {};
  options.cells = 0;
  EXPECT_THROW(FeatureCamera(world, field, options, {}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::feature_camera_test
