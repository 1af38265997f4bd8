// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/body_clearance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "tests/engine/obstacle_worlds.h"

namespace prospect::body_clearance_test {
namespace {

using test::random_world;

std::shared_ptr<const ClearanceField> field_of(std::uint64_t seed, bool vertical) {
  const auto world = random_world(seed, 0.1, 3.0);
  ClearanceField::Options options;
  options.vertical = vertical;
  options.reach = 2.5;
  options.vertical_reach = 0.6;
  return std::make_shared<const ClearanceField>(Eigen::Vector3d(0.0, 0.0, 0.4), world.voxels,
                                                world.ground, options);
}

std::vector<RobotShape> shapes() {
  SphereSetShape spheres;
  spheres.spheres = {{{0.1, 0.05, 0.2}, 0.15}, {{-0.12, 0.0, 0.25}, 0.1}, {{0.0, -0.1, 0.2}, 0.2}};
  ConvexShape hull;
  hull.vertices = {{0.2, 0.0, 0.0}, {-0.15, 0.12, 0.0}, {-0.15, -0.12, 0.0}, {0.0, 0.0, 0.3}};
  return {spheres, BoxShape{{0.02, 0.0, 0.2}, {0.5, 0.3, 0.3}}, CylinderShape{}, hull};
}

TEST(BodyClearance, IsTheSoftMinimumOverTheBodies) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-2.3, 2.3), angle(-7.0, 7.0);
  for (const bool vertical : {false, true}) {
    const auto field = field_of(3, vertical);
    for (const RobotShape& shape : shapes()) {
      const double T = 0.01;
      const BodyClearance body(field, shape, T);
      for (int sample = 0; sample < 300; ++sample) {
        const Pose pose{{place(random), place(random), 0.3}, angle(random)};
        double smallest = 1e9, sum = 0.0;
        std::vector<double> each;
        for (const Sphere& s : body.bodies()) {
          const Eigen::Vector3d p =
              pose.position + Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()) * s.center;
          each.push_back(field->distance(p) - s.radius);
          smallest = std::min(smallest, each.back());
        }
        for (const double d : each) sum += std::exp(-(d - smallest) / T);
        const double d = body.clearance(pose);
        EXPECT_NEAR(d, smallest - T * std::log(sum), 1e-12);
        EXPECT_LE(d, smallest + 1e-12);
        EXPECT_GE(d, smallest - T * std::log(static_cast<double>(each.size())) - 1e-12);
        EXPECT_LE(d, body.saturation() + 1e-12);
        if (each.size() == 1) {
          EXPECT_NEAR(d, smallest, 1e-15);
        }
      }
    }
  }
}

TEST(BodyClearance, GradientMatchesFiniteDifferences) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-2.8, 2.8), angle(-7.0, 7.0);
  constexpr double kStep = 1e-6;
  for (const bool vertical : {false, true}) {
    const auto field = field_of(4, vertical);
    for (const RobotShape& shape : shapes()) {
      const BodyClearance body(field, shape);
      for (int sample = 0; sample < 300; ++sample) {
        const Pose pose{{place(random), place(random), 0.2 + 0.1 * place(random)}, angle(random)};
        Eigen::Vector4d g;
        body.clearance(pose, &g);
        for (int a = 0; a < 4; ++a) {
          Pose low = pose, high = pose;
          (a < 3 ? low.position[a] : low.yaw) -= kStep;
          (a < 3 ? high.position[a] : high.yaw) += kStep;
          const double slope = (body.clearance(high) - body.clearance(low)) / (2.0 * kStep);
          EXPECT_NEAR(g[a], slope, 3e-4);
        }
      }
    }
  }
}

TEST(BodyClearance, NeverNonFinite) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-9.0, 200.0), angle(-1e6, 1e6);
  for (const bool vertical : {false, true}) {
    const auto field = field_of(5, vertical);
    for (const RobotShape& shape : shapes()) {
      const BodyClearance body(field, shape);
      for (int sample = 0; sample < 500; ++sample) {
        const double far = std::pow(10.0, exponent(random));
        Eigen::Vector4d g;
        ASSERT_TRUE(std::isfinite(
            body.clearance({{far, -far, sample % 2 == 0 ? far : 0.1}, angle(random)}, &g)));
        ASSERT_TRUE(g.allFinite());
      }
    }
  }
}

TEST(BodyClearance, RejectsAFieldThatIsTooShortSighted) {
  const auto field = field_of(1, false);
  EXPECT_THROW(BodyClearance(nullptr, CylinderShape{}), std::invalid_argument);
  EXPECT_THROW(BodyClearance(field, CylinderShape{{0.0, 0.0, 0.3}, 0.9, 0.4}),
               std::invalid_argument);
  EXPECT_THROW(BodyClearance(field, CylinderShape{{0.0, 0.0, 0.3}, -0.1, 0.4}),
               std::invalid_argument);
  EXPECT_THROW(BodyClearance(field, CylinderShape{}, 0.0), std::invalid_argument);
}

TEST(BodyClearance, OfABodyThatIsBoundedAlreadyIsTheSame) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-2.3, 2.3);
  for (const bool vertical : {false, true}) {
    const auto field = field_of(3, vertical), other = field_of(4, vertical);
    for (const RobotShape& shape : shapes()) {
      const BodyClearance bounded(field, shape, 0.02), expected(other, shape, 0.02);
      const BodyClearance body(other, bounded);
      EXPECT_EQ(body.saturation(), expected.saturation());
      for (int sample = 0; sample < 50; ++sample) {
        const Pose pose{{place(random), place(random), 0.3}, place(random)};
        EXPECT_EQ(body.clearance(pose), expected.clearance(pose));
      }
    }
  }
  const BodyClearance planar(field_of(1, false), CylinderShape{});
  EXPECT_THROW(BodyClearance(field_of(1, true), planar), std::invalid_argument);
  EXPECT_THROW(BodyClearance(nullptr, planar), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::body_clearance_test
