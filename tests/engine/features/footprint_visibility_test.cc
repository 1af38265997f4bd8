// SPDX-License-Identifier: Apache-2.0
#include "engine/features/footprint_visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "tests/engine/view_worlds.h"
#include "tests/not_under_sanitizers.h"

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

/// Gradients at random poses against central differences of `step` [m], [rad].
void expect_gradients(const FootprintVisibility& view, int poses, double step, double tolerance,
                      std::mt19937_64& random) {
  FootprintVisibility::Scratch scratch(view.size());
  std::vector<double> weight(150), q(150);
  for (int n = 0; n < poses; ++n) {
    const Pose pose = random_pose(random);
    for (double& w : weight) w = uniform(random, -1, 1);
    const Eigen::Vector4d g = view.gradient(pose, weight.data(), scratch);
    for (int a = 0; a < 4; ++a) {
      double difference = 0.0;
      for (const double sign : {-1.0, 1.0}) {
        Pose moved = pose;
        (a < 3 ? moved.position[a] : moved.yaw) += sign * step;
        view.evaluate(moved, scratch, q.data());
        for (std::size_t c = 0; c < q.size(); ++c) difference += sign * weight[c] * q[c];
      }
      EXPECT_NEAR(g[a], difference / (2 * step), tolerance * std::max(1.0, std::abs(g[a]))) << a;
    }
  }
}

TEST(FootprintVisibility, GradientIsThatOfTheWeightedSum) {
  std::mt19937_64 random(2);
  for (const bool vertical : {false, true}) {
    const Scene s = scene(random, vertical);
    const FootprintVisibility view(s.footprint, s.mount, s.table);
    expect_gradients(view, 50, 1e-5, 1e-5, random);
  }
}

constexpr double kDegree = M_PI / 180.0;

/// Fields of view of all kinds [degrees], horizontal and vertical.
const std::vector<std::pair<double, double>> kFields = {
    {1, 54},   {7, 1},    {70, 0},   {120, 30}, {179, 54},   {180, 54},  {181, 54}, {220, 2},
    {270, 54}, {300, 30}, {340, 54}, {352, 54}, {359.9, 54}, {360, 0.1}, {360, 90}, {360, 180}};

RgbdFootprint field(double horizontal, double vertical, double max_range = 4.0) {
  return {horizontal * kDegree, vertical * kDegree, 0.3, max_range};
}

// What lies well within the field is seen, what lies well beside it is not, whatever its width.
TEST(FootprintVisibility, AnyFieldOfViewSeesWhatIsInIt) {
  for (const auto& [horizontal, vertical] : kFields) {
    SCOPED_TRACE(horizontal);
    const FootprintVisibility view(field(horizontal, vertical), CameraMount());
    const auto at = [&](double azimuth, double elevation) {
      const double a = azimuth * kDegree, e = elevation * kDegree;
      return view.in_footprint(
          Pose(), Eigen::Vector3d(2 * std::cos(a) * std::cos(e), 2 * std::sin(a) * std::cos(e),
                                  0.45 + 2 * std::sin(e)));
    };
    EXPECT_GT(at(0, 0), 0.9);
    for (double azimuth = -180; azimuth <= 180; azimuth += 2.5) {
      const double inside = 0.5 * horizontal - std::abs(azimuth);
      if (inside > 20) {
        EXPECT_GT(at(azimuth, 0), 0.9) << azimuth;
      }
      // Beside it, and beside the least width that counts; a gap of some degrees is none.
      if (inside < -1 && std::abs(azimuth) > 5 && horizontal < 350) {
        EXPECT_LT(at(azimuth, 0), 0.13) << azimuth;
      }
      EXPECT_EQ(at(azimuth, 0), at(-azimuth, 0));
    }
    EXPECT_EQ(at(180, 0) > 0.9, horizontal > 352);
    for (double elevation = 5; elevation < 90; elevation += 5) {
      if (elevation > 0.5 * vertical + 1) {
        EXPECT_LT(at(0, elevation), 0.13) << elevation;
      }
      if (elevation < 0.5 * vertical - 20) {
        EXPECT_GT(at(0, elevation), 0.9) << elevation;
      }
    }
    if (horizontal >= 360) {
      for (double azimuth = -180; azimuth <= 180; azimuth += 7) {
        EXPECT_NEAR(at(azimuth, 0), at(0, 0), 1e-9);
      }
    }
  }
  // Written with few digits, it is all round as well.
  RgbdFootprint rounded;
  rounded.horizontal_fov = 6.2832;
  EXPECT_GT(FootprintVisibility(rounded, CameraMount()).in_footprint(Pose(), {-2, 0, 0.45}), 0.9);
}

TEST(FootprintVisibility, WideningTheFieldHidesNothing) {
  for (double azimuth = 0; azimuth <= 180; azimuth += 5) {
    double previous = 0.0;
    for (double horizontal = 100; horizontal <= 360; horizontal += 1) {
      const FootprintVisibility view(field(horizontal, 54), CameraMount());
      const double q = view.in_footprint(
          Pose(), {2 * std::cos(azimuth * kDegree), 2 * std::sin(azimuth * kDegree), 0.45});
      EXPECT_GE(q, previous - 0.02) << horizontal << " at " << azimuth;
      previous = q;
    }
  }
}

TEST(FootprintVisibility, GradientsOfAnyFieldAreThoseOfTheWeightedSum) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(11);
  for (const auto& [horizontal, vertical] : kFields) {
    SCOPED_TRACE(horizontal);
    Scene s = scene(random, true);
    s.footprint = field(horizontal, vertical);
    const FootprintVisibility view(s.footprint, s.mount, s.table);
    expect_gradients(view, 20, 1e-6, 1e-4, random);
  }
}

// Behind the robot the azimuth jumps from pi to -pi; what is seen does not, nor do its derivatives.
TEST(FootprintVisibility, NothingJumpsAtTheSeamBehindTheSensor) {
  const VoxelGrid empty(GridFrame{0.1, -60, -60, 120, 120}, 0.0, 1.0);
  const std::vector<Eigen::Vector3d> points = {{-2.0, 0.0, 0.45}};
  const auto table = std::make_shared<const OcclusionTable>(
      SensorLattice::around({0, 0, 0.45}, 1.0, 0.2), points, empty, OcclusionTable::Options());
  for (const double horizontal : {181.0, 270.0, 330.0, 350.0, 352.0, 353.5, 359.9, 360.0}) {
    SCOPED_TRACE(horizontal);
    const FootprintVisibility view(field(horizontal, 54), CameraMount(), table);
    FootprintVisibility::Scratch scratch(1);
    const double weight = 1.0;
    double before = -1.0;
    Eigen::Vector4d slope = Eigen::Vector4d::Zero();
    for (double y = -0.05; y <= 0.05; y += 1e-4) {
      const Pose pose{{0.0, y, 0.0}, 0.3 * y};
      double q;
      view.evaluate(pose, scratch, &q);
      const Eigen::Vector4d now = view.gradient(pose, &weight, scratch);
      ASSERT_TRUE(now.allFinite());
      if (before >= 0.0) {
        ASSERT_NEAR(q, before, 2e-3);
        ASSERT_LT((now - slope).norm(), 0.1);
      }
      before = q;
      slope = now;
      if (horizontal > 353) {
        ASSERT_NEAR(now[3], 0.0, 1e-9) << "turning shows nothing more";
      }
    }
  }
}

TEST(FootprintVisibility, ScoresOfAnyFieldAreWithinTheirBound) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(12);
  double worst = 0.0;
  for (const auto& [horizontal, vertical] : kFields) {
    Scene s = scene(random, true);
    s.footprint = field(horizontal, vertical, 8.0);
    const FootprintVisibility view(s.footprint, s.mount, s.table);
    FootprintVisibility::Scratch scratch(view.size());
    std::vector<double> exact(150), score(static_cast<std::size_t>(view.capacity()));
    std::vector<int> point(static_cast<std::size_t>(view.capacity()));
    for (int n = 0; n < 50; ++n) {
      const Pose pose = random_pose(random);
      view.evaluate(pose, scratch, exact.data());
      FootprintVisibility::Views views{.point = point.data(), .q = score.data()};
      views.score = true;
      const int count = view.view(pose, scratch, views);
      for (int j = 0; j < count; ++j) {
        const auto at = static_cast<std::size_t>(j);
        worst = std::max(worst, std::abs(score[at] - exact[static_cast<std::size_t>(point[at])]));
      }
    }
  }
  EXPECT_LT(worst, 1e-5);
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
  for (const double angle : {0.0, -1.0, 6.3, std::nan("")}) {
    RgbdFootprint footprint;
    footprint.horizontal_fov = angle;
    EXPECT_THROW(FootprintVisibility(footprint, CameraMount()), std::invalid_argument) << angle;
    footprint = {};
    footprint.vertical_fov = angle == 0.0 ? 3.2 : angle;
    EXPECT_THROW(FootprintVisibility(footprint, CameraMount()), std::invalid_argument) << angle;
  }
  RgbdFootprint inverted;
  inverted.max_range = 0.1;
  EXPECT_THROW(FootprintVisibility(inverted, CameraMount()), std::invalid_argument);
  EXPECT_THROW(FootprintVisibility(RgbdFootprint(), CameraMount(), nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::footprint_visibility_test
