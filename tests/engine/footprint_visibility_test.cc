#include "engine/footprint_visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "tests/engine/view_worlds.h"

namespace prospect::footprint_visibility_test {
namespace {

using test::uniform;

struct Scene {
  std::shared_ptr<const OcclusionTable> table;
  CameraMount mount;
  RgbdFootprint footprint;
};

Scene scene(std::mt19937_64& random, bool vertical) {
  Scene s;
  const VoxelGrid grid = test::hall(random, true);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 150; ++i) {
    points.emplace_back(uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, 0.1, 1.5));
  }
  s.table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.5, 0.2, vertical), points, grid,
      OcclusionTable::Options());
  s.mount.T_BC = CameraMount::forward_facing({0.15, -0.05, 0.45}, 0.3, 0.2);
  return s;
}

Pose random_pose(std::mt19937_64& random) {
  return {{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -0.2, 0.2)},
          uniform(random, -4, 4)};
}

TEST(FootprintVisibility, IsTheProductOfItsFactors) {
  std::mt19937_64 random(1);
  const Scene s = scene(random, true);
  const FootprintVisibility view(s.footprint, s.mount, s.table);
  const FootprintVisibility::Options o;
  FootprintVisibility::Scratch scratch(view.size());
  const auto sigmoid = [](double a) { return 1.0 / (1.0 + std::exp(-a)); };
  double largest = 0.0;
  for (int n = 0; n < 50; ++n) {
    const Pose pose = random_pose(random);
    std::vector<double> q(150), occlusion(150);
    view.evaluate(pose, scratch, q.data());
    const Eigen::Isometry3d T_WC =
        Eigen::Translation3d(pose.position) *
        Eigen::Isometry3d(Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ())) * s.mount.T_BC;
    s.table->evaluate(T_WC.translation(), occlusion.data());
    for (std::size_t c = 0; c < q.size(); ++c) {
      const Eigen::Vector3d Y = T_WC.inverse() * s.table->points()[c];
      const double r = Y.norm(), azimuth = std::atan2(Y.x(), Y.z()),
                   elevation = std::asin(Y.y() / r);
      const double h = s.footprint.horizontal_fov / 2, v = s.footprint.vertical_fov / 2;
      double expected = occlusion[c];
      for (const double sign : {-1.0, 1.0}) {
        expected *= sigmoid(std::sin(h + sign * azimuth) / o.angle_scale - o.inset);
        expected *= sigmoid(std::sin(v + sign * elevation) / o.angle_scale - o.inset);
      }
      expected *= sigmoid((r - s.footprint.min_range) / o.range_scale - o.inset);
      expected *= sigmoid((s.footprint.max_range - r) / o.range_scale - o.inset);
      // The distances' regularisation (2 cm) is all that may differ.
      ASSERT_NEAR(q[c], expected, 2e-4 * 4.0 / std::max(r, 0.3)) << "r " << r;
      ASSERT_NEAR(view.in_footprint(pose, s.table->points()[c]) * occlusion[c], q[c], 5e-11);
      largest = std::max(largest, q[c]);
    }
  }
  EXPECT_GT(largest, 0.9);
}

TEST(FootprintVisibility, CountsOnlyWhatTheSensorResolves) {
  const FootprintVisibility view{RgbdFootprint(), CameraMount()};
  const Pose pose;
  EXPECT_GT(view.in_footprint(pose, {2.0, 0.0, 0.45}), 0.95);
  EXPECT_LT(view.in_footprint(pose, {4.0, 0.0, 0.45}), 0.13);  // the true edge of range
  EXPECT_LT(view.in_footprint(pose, {2 * std::cos(0.61), 2 * std::sin(0.61), 0.45}), 0.13);
  EXPECT_LT(view.in_footprint(pose, {-2.0, 0.0, 0.45}), 1e-6);
  EXPECT_LT(view.in_footprint(pose, {0.0, 0.0, 0.45}), 0.1);
  EXPECT_EQ(view.in_footprint(pose, {std::nan(""), 0.0, 0.45}), 0.0);
}

TEST(FootprintVisibility, GradientIsThatOfTheWeightedSum) {
  std::mt19937_64 random(2);
  for (const bool vertical : {false, true}) {
    const Scene s = scene(random, vertical);
    const FootprintVisibility view(s.footprint, s.mount, s.table);
    FootprintVisibility::Scratch scratch(view.size());
    std::vector<double> weight(150), q(150);
    for (int n = 0; n < 50; ++n) {
      const Pose pose = random_pose(random);
      for (double& w : weight) w = uniform(random, -1, 1);
      const Eigen::Vector4d g = view.gradient(pose, weight.data(), scratch);
      for (int a = 0; a < 4; ++a) {
        const double step = 1e-5;
        double difference = 0.0;
        for (const double sign : {-1.0, 1.0}) {
          Pose moved = pose;
          (a < 3 ? moved.position[a] : moved.yaw) += sign * step;
          view.evaluate(moved, scratch, q.data());
          for (std::size_t c = 0; c < q.size(); ++c) difference += sign * weight[c] * q[c];
        }
        EXPECT_NEAR(g[a], difference / (2 * step), 1e-5 * std::max(1.0, std::abs(g[a]))) << a;
      }
    }
  }
}

TEST(FootprintVisibility, FiniteWithPointsAtTheSensor) {
  const VoxelGrid empty(GridFrame{0.1, -40, -40, 80, 80}, 0.0, 1.0);
  CameraMount mount;
  const std::vector<Eigen::Vector3d> points = {
      {0, 0, 0.45}, {1e-12, 0, 0.45}, {0, 0, 3}, {0, 0, -3}};
  const auto table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), points, empty, OcclusionTable::Options());
  const FootprintVisibility view(RgbdFootprint(), mount, table);
  FootprintVisibility::Scratch scratch(view.size());
  std::vector<double> q(4), weight(4, 1.0);
  view.evaluate(Pose(), scratch, q.data());
  for (const double v : q) EXPECT_TRUE(v >= 0.0 && v <= 1.0);
  EXPECT_TRUE(view.gradient(Pose(), weight.data(), scratch).allFinite());
  Pose bad;
  bad.yaw = std::numeric_limits<double>::infinity();
  view.evaluate(bad, scratch, q.data());
  EXPECT_TRUE(std::isnan(q[0]));
}

TEST(FootprintVisibility, RefusesWhatItCannotModel) {
  RgbdFootprint wide;
  wide.horizontal_fov = 4.0;
  EXPECT_THROW(FootprintVisibility(wide, CameraMount()), std::invalid_argument);
  RgbdFootprint inverted;
  inverted.max_range = 0.1;
  EXPECT_THROW(FootprintVisibility(inverted, CameraMount()), std::invalid_argument);
  EXPECT_THROW(FootprintVisibility(RgbdFootprint(), CameraMount(), nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::footprint_visibility_test
