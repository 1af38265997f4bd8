// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/shape_geometry.h"

#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace prospect::shape_geometry_test {
namespace {

bool contains(const std::vector<PlacedGeometry>& parts, const Eigen::Vector3d& p) {
  // A tiny ball: FCL has no test for a point.
  const fcl::Sphered ball(1e-6);
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.translation() = p;
  for (const PlacedGeometry& part : parts) {
    fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    fcl::collide(part.geometry.get(), part.T_BG, &ball, T, request, result);
    if (result.isCollision()) return true;
  }
  return false;
}

struct Case {
  RobotShape shape;
  double (*outside)(const Eigen::Vector3d&);  // distance from the shape, 0 inside
};

double cylinder_gap(const Eigen::Vector3d& p) {
  const double radial = std::max(0.0, (p.head<2>() - Eigen::Vector2d(0.1, 0.0)).norm() - 0.2);
  const double axial = std::max(0.0, std::abs(p.z() - 0.3) - 0.2);
  return std::hypot(radial, axial);
}
double box_gap(const Eigen::Vector3d& p) {
  return ((p - Eigen::Vector3d(0.05, -0.02, 0.2)).cwiseAbs() - Eigen::Vector3d(0.25, 0.15, 0.1))
      .cwiseMax(0.0)
      .norm();
}
double spheres_gap(const Eigen::Vector3d& p) {
  return std::max(0.0, std::min((p - Eigen::Vector3d(0.1, 0.0, 0.2)).norm() - 0.15,
                                (p - Eigen::Vector3d(-0.2, 0.1, 0.2)).norm() - 0.1));
}
// A box again, given by its corners, so that the reference is simple.
double hull_gap(const Eigen::Vector3d& p) { return box_gap(p); }

std::vector<Case> cases() {
  ConvexShape hull;
  for (int corner = 0; corner < 8; ++corner) {
    hull.vertices.push_back(Eigen::Vector3d(0.05, -0.02, 0.2) +
                            Eigen::Vector3d((corner & 1) ? 0.25 : -0.25,
                                            (corner & 2) ? 0.15 : -0.15,
                                            (corner & 4) ? 0.1 : -0.1));
  }
  hull.vertices.push_back({0.05, -0.02, 0.2});  // an interior point does no harm
  SphereSetShape spheres;
  spheres.spheres = {{{0.1, 0.0, 0.2}, 0.15}, {{-0.2, 0.1, 0.2}, 0.1}};
  return {{CylinderShape{{0.1, 0.0, 0.3}, 0.2, 0.4}, cylinder_gap},
          {BoxShape{{0.05, -0.02, 0.2}, {0.5, 0.3, 0.2}}, box_gap},
          {spheres, spheres_gap},
          {hull, hull_gap}};
}

TEST(ShapeGeometry, IsTheShapeAndGrowsByTheInflation) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-0.6, 0.6);
  for (const Case& c : cases()) {
    for (const double inflation : {0.0, 0.03}) {
      const auto parts = shape_geometry(c.shape, inflation);
      int in = 0, out = 0;
      for (int sample = 0; sample < 4000; ++sample) {
        const Eigen::Vector3d p(place(random), place(random), 0.2 + place(random));
        const double gap = c.outside(p);
        if (gap < inflation - 1e-4 || gap == 0.0) {
          EXPECT_TRUE(contains(parts, p)) << p.transpose();
          ++in;
        } else if (gap > inflation * std::sqrt(3.0) + 1e-4) {
          EXPECT_FALSE(contains(parts, p)) << p.transpose();
          ++out;
        }
      }
      EXPECT_GT(in, 20);
      EXPECT_GT(out, 20);
    }
  }
}

TEST(ShapeGeometry, RejectsBadInflationAndBadShapes) {
  EXPECT_THROW(shape_geometry(CylinderShape{}, -0.01), std::invalid_argument);
  EXPECT_THROW(shape_geometry(CylinderShape{}, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_THROW(shape_geometry(SphereSetShape{}), std::invalid_argument);
  EXPECT_THROW(shape_geometry(BoxShape{{0.0, 0.0, 0.0}, {0.1, 0.0, 0.1}}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::shape_geometry_test
