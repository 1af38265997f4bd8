// SPDX-License-Identifier: Apache-2.0
#include "models/robot_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::robot_shape_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

class RobotShapes : public testing::Test {
 protected:
  std::mt19937_64 rng_{5};
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  Vector3d direction() {
    std::normal_distribution<double> normal;
    return Vector3d(normal(rng_), normal(rng_), normal(rng_)).normalized();
  }
  Vector3d vector(double a) { return {uniform(-a, a), uniform(-a, a), uniform(-a, a)}; }

  /// A random point of the body; half of them on its surface (hulls: on edges between vertices
  /// too).
  Vector3d point(const RobotShape& shape) {
    const bool surface = uniform(0.0, 1.0) < 0.5;
    if (const auto* s = std::get_if<SphereSetShape>(&shape)) {
      const Sphere& sphere = s->spheres[rng_() % s->spheres.size()];
      return sphere.center +
             sphere.radius * (surface ? 1.0 : std::cbrt(uniform(0.0, 1.0))) * direction();
    }
    if (const auto* s = std::get_if<BoxShape>(&shape)) {
      Vector3d p = vector(0.5);
      if (surface) {
        for (int i = 0; i < 3; ++i) {
          if (rng_() % 2 == 0) p[i] = p[i] > 0.0 ? 0.5 : -0.5;  // faces, edges and corners
        }
      }
      return s->center + p.cwiseProduct(s->size);
    }
    if (const auto* s = std::get_if<CylinderShape>(&shape)) {
      const double angle = uniform(-kPi, kPi);
      const double r = s->radius * (surface ? 1.0 : std::sqrt(uniform(0.0, 1.0)));
      const double z = rng_() % 3 == 0 ? (rng_() % 2 ? 0.5 : -0.5) : uniform(-0.5, 0.5);
      return s->center + Vector3d(r * std::cos(angle), r * std::sin(angle), z * s->height);
    }
    const auto& vertices = std::get<ConvexShape>(shape).vertices;
    Vector3d p = Vector3d::Zero();
    double sum = 0.0;
    const int corners = surface ? 1 + static_cast<int>(rng_() % 3) : 6;
    for (int i = 0; i < corners; ++i) {
      const double weight = -std::log(uniform(1e-12, 1.0));
      p += weight * vertices[rng_() % vertices.size()];
      sum += weight;
    }
    return p / sum;
  }

  ConvexShape random_hull() {
    ConvexShape hull;
    const int n = 4 + static_cast<int>(rng_() % 20);
    const Vector3d stretch(uniform(0.05, 0.5), uniform(0.05, 0.5), uniform(0.05, 0.5));
    const Vector3d center = vector(0.3);
    for (int i = 0; i < n; ++i) hull.vertices.push_back(center + vector(1.0).cwiseProduct(stretch));
    return hull;
  }

  std::vector<RobotShape> shapes() {
    std::vector<RobotShape> shapes = {
        SphereSetShape{{{{0, 0, 0.2}, 0.2}, {{0.3, 0, 0.3}, 0.1}, {{0.02, 0, 0.3}, 0.05}}},
        BoxShape{}, BoxShape{{0.1, -0.2, 0.4}, {1.2, 0.3, 0.5}},
        BoxShape{{0, 0, 0}, {0.3, 1.2, 0.1}}, BoxShape{{0, 0, 0}, {0.5, 0.5, 0.5}},
        BoxShape{{0, 0, 0}, {3.0, 0.01, 0.01}}, CylinderShape{},
        CylinderShape{{0.1, 0.1, 0.0}, 0.05, 1.5}, CylinderShape{{0.0, 0.0, 0.1}, 0.4, 0.05},
        // Pyramid, tetrahedron, octagonal prism.
        ConvexShape{{{0.3, 0.3, 0}, {-0.3, 0.3, 0}, {0.3, -0.3, 0}, {-0.3, -0.3, 0}, {0, 0, 0.8}}},
        ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    ConvexShape octagon;
    for (int i = 0; i < 8; ++i) {
      const double angle = kPi / 8.0 + i * kPi / 4.0;
      for (double z : {0.0, 0.4})
        octagon.vertices.push_back({0.3 * std::cos(angle), 0.3 * std::sin(angle), z});
    }
    shapes.push_back(octagon);
    // Flat hulls, and points doubled or collinear on its outline.
    ConvexShape doubled = octagon;
    doubled.vertices.insert(doubled.vertices.end(), octagon.vertices.begin(),
                            octagon.vertices.end());
    doubled.vertices.push_back(0.5 * (octagon.vertices[0] + octagon.vertices[2]));
    shapes.push_back(doubled);
    shapes.push_back(ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1e-5}}});
    shapes.push_back(ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.3, 1e-5, 0.3}}});
    for (int n = 0; n < 12; ++n) shapes.push_back(random_hull());
    for (int n = 0; n < 6; ++n) {
      shapes.push_back(
          BoxShape{vector(0.5), {uniform(0.05, 1.0), uniform(0.05, 1.0), uniform(0.05, 1.0)}});
      shapes.push_back(CylinderShape{vector(0.5), uniform(0.05, 0.5), uniform(0.05, 1.0)});
    }
    return shapes;
  }
};

bool covered(const std::vector<Disc>& discs, const Vector3d& p) {
  return std::any_of(discs.begin(), discs.end(), [&](const Disc& d) {
    return (p.head<2>() - d.center).norm() <= d.radius * (1.0 + 1e-12);
  });
}

bool covered(const std::vector<Sphere>& spheres, const Vector3d& p) {
  return std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& s) {
    return (p - s.center).norm() <= s.radius * (1.0 + 1e-12);
  });
}

/// Farthest reach of the discs beyond a box's ground outline, by walking around every disc.
double measured_overhang(const std::vector<Disc>& discs, const BoxShape& box) {
  double overhang = 0.0;
  for (const Disc& d : discs) {
    for (int i = 0; i < 3600; ++i) {
      const double angle = 2.0 * kPi * i / 3600;
      const Vector2d p = d.center + d.radius * Vector2d(std::cos(angle), std::sin(angle));
      const Vector2d outside =
          ((p - box.center.head<2>()).cwiseAbs() - 0.5 * box.size.head<2>()).cwiseMax(0.0);
      overhang = std::max(overhang, outside.norm());
    }
  }
  return overhang;
}

double measured_overhang(const std::vector<Sphere>& spheres, const BoxShape& box,
                         std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  double overhang = 0.0;
  for (const Sphere& s : spheres) {
    for (int i = 0; i < 2000; ++i) {
      Vector3d e = i < 6 ? Vector3d((i % 2 ? 1.0 : -1.0) * Vector3d::Unit(i / 2))
                         : Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
      const Vector3d p = s.center + s.radius * e;
      overhang =
          std::max(overhang, ((p - box.center).cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm());
    }
  }
  return overhang;
}

TEST_F(RobotShapes, BoundsContainEveryPointOfTheBody) {
  int index = 0;
  for (const RobotShape& shape : shapes()) {
    SCOPED_TRACE("shape " + std::to_string(index++));
    const std::vector<Disc> discs = bounding_discs(shape);
    const std::vector<Sphere> spheres = bounding_spheres(shape);
    const VerticalExtent extent = vertical_extent(shape);
    const double radius = circumscribed_radius(shape);
    ASSERT_FALSE(discs.empty());
    ASSERT_FALSE(spheres.empty());
    ASSERT_LE(discs.size(), 8u);
    ASSERT_LE(spheres.size(), 64u);
    for (int n = 0; n < 4000; ++n) {
      const Vector3d p = point(shape);
      ASSERT_TRUE(covered(discs, p)) << p.transpose();
      ASSERT_TRUE(covered(spheres, p)) << p.transpose();
      ASSERT_GE(p.z(), extent.z_min - 1e-12);
      ASSERT_LE(p.z(), extent.z_max + 1e-12);
      ASSERT_LE(p.head<2>().norm(), radius * (1.0 + 1e-12));
    }
  }
}

TEST_F(RobotShapes, ExtentAndCircumscribedRadiusAreTight) {
  for (const RobotShape& shape : shapes()) {
    double z_min = 1e9, z_max = -1e9, radius = 0.0;
    for (int n = 0; n < 40000; ++n) {
      const Vector3d p = point(shape);
      z_min = std::min(z_min, p.z());
      z_max = std::max(z_max, p.z());
      radius = std::max(radius, p.head<2>().norm());
    }
    EXPECT_NEAR(vertical_extent(shape).z_min, z_min, 0.002);
    EXPECT_NEAR(vertical_extent(shape).z_max, z_max, 0.002);
    EXPECT_NEAR(circumscribed_radius(shape), radius, 0.002);
  }
}

TEST_F(RobotShapes, DiscsOfABoxOverhangNoMoreThanAsked) {
  for (const BoxShape& box :
       {BoxShape{{0.1, 0.0, 0.2}, {0.4, 0.2, 0.3}}, BoxShape{{0, 0, 0}, {0.3, 0.1, 0.3}},
        BoxShape{{0, 0, 0}, {0.2, 0.3, 0.3}}, BoxShape{}}) {
    for (double overhang : {0.035, 0.05, 0.08, 0.2}) {
      const std::vector<Disc> discs = bounding_discs(box, overhang);
      EXPECT_LE(discs.size(), 8u);
      EXPECT_LE(measured_overhang(discs, box), overhang) << box.size.transpose();
    }
  }
}

TEST_F(RobotShapes, TheDefaultBoxKeepsToTheDefaultOverhang) {
  const BoxShape box;
  const std::vector<Disc> discs = bounding_discs(box);
  EXPECT_LE(measured_overhang(discs, box), 0.03);
  RecordProperty("discs", static_cast<int>(discs.size()));
}

TEST_F(RobotShapes, MoreDiscsOnlyWhereTheyAreNeeded) {
  const BoxShape box{{0, 0, 0}, {0.6, 0.4, 0.3}};
  EXPECT_EQ(bounding_discs(box, 1.0).size(), 1u);  // the circumscribed circle will do
  EXPECT_NEAR(bounding_discs(box, 1.0)[0].radius, std::hypot(0.3, 0.2), 2e-9);
  std::size_t last = 1;
  for (double overhang = 0.2; overhang > 0.005; overhang *= 0.95) {
    const std::vector<Disc> discs = bounding_discs(box, overhang);
    if (measured_overhang(discs, box) > overhang) break;  // beyond what eight discs can do
    EXPECT_GE(discs.size(), last) << overhang;
    last = discs.size();
  }
  EXPECT_GE(last, 4u);
  // Best effort beyond that: what eight discs can do does not depend on how much less was asked.
  EXPECT_EQ(measured_overhang(bounding_discs(box, 1e-3), box),
            measured_overhang(bounding_discs(box, 1e-4), box));
}

TEST_F(RobotShapes, ASquareIsCoveredAsWellAsByAGridOrBetter) {
  // A grid of 2 x 2 has an overhang of (sqrt 2 - 1)/2 of the half side; eight discs may beat it.
  const BoxShape box{{0, 0, 0}, {1.0, 1.0, 1.0}};
  EXPECT_LE(measured_overhang(bounding_discs(box, 1e-3), box),
            (std::sqrt(2.0) - 1.0) * 0.25 + 1e-6);
}

TEST_F(RobotShapes, SpheresOfABoxOverhangNoMoreThanAsked) {
  for (const BoxShape& box : {BoxShape{}, BoxShape{{0.1, 0.2, 0.3}, {0.5, 0.5, 0.2}},
                              BoxShape{{0, 0, 0}, {0.2, 0.1, 0.6}}}) {
    for (double overhang : {0.05, 0.08, 0.15, 1.0}) {
      const std::vector<Sphere> spheres = bounding_spheres(box, overhang);
      EXPECT_LE(measured_overhang(spheres, box, rng_), overhang)
          << box.size.transpose() << ' ' << overhang;
    }
    EXPECT_EQ(bounding_spheres(box, 1.0).size(), 1u);
  }
}

TEST_F(RobotShapes, DiscsAreExactForCylindersAndSpheres) {
  const std::vector<Disc> cylinder = bounding_discs(CylinderShape{{0.1, 0.2, 0.3}, 0.25, 0.4});
  ASSERT_EQ(cylinder.size(), 1u);
  EXPECT_EQ(cylinder[0].center, Vector2d(0.1, 0.2));
  EXPECT_EQ(cylinder[0].radius, 0.25);
  // One inside another's shadow goes; of two equal ones one stays.
  const std::vector<Disc> set = bounding_discs(SphereSetShape{
      {{{0, 0, 0}, 0.2}, {{0, 0, 0.5}, 0.2}, {{0.05, 0, 0.3}, 0.1}, {{0.3, 0, 0}, 0.1}}});
  ASSERT_EQ(set.size(), 2u);
  EXPECT_EQ(set[0].radius, 0.2);
  EXPECT_EQ(set[1].center, Vector2d(0.3, 0.0));
  EXPECT_EQ(bounding_spheres(SphereSetShape{{{{1, 2, 3}, 0.5}}})[0].center, Vector3d(1, 2, 3));
}

TEST_F(RobotShapes, AnOctagonalHullIsNearlyADisc) {
  ConvexShape octagon;
  for (int i = 0; i < 8; ++i) {
    for (double z : {0.0, 0.4}) {
      octagon.vertices.push_back({0.3 * std::cos(i * kPi / 4.0), 0.3 * std::sin(i * kPi / 4.0), z});
    }
  }
  const std::vector<Disc> discs = bounding_discs(octagon);  // overhang 0.3 (1 - cos(pi/8)) = 0.023
  ASSERT_EQ(discs.size(), 1u);
  EXPECT_NEAR(discs[0].radius, 0.3, 2e-9);
  EXPECT_LE(discs[0].center.norm(), 1e-12);
}

// Points of the body lie within the outline, and the disc of the inscribed radius, too.
TEST_F(RobotShapes, OutlinesHoldTheBodyAndTheInscribedDisc) {
  const auto in_outline = [](const std::vector<OutlinePart>& outline, const Eigen::Vector2d& p) {
    return std::any_of(outline.begin(), outline.end(), [&](const OutlinePart& part) {
      if (part.corners.size() == 1) return (p - part.corners[0]).norm() <= part.radius + 1e-9;
      for (std::size_t i = 0; i < part.corners.size(); ++i) {
        const Eigen::Vector2d edge = part.corners[(i + 1) % part.corners.size()] - part.corners[i];
        const Eigen::Vector2d to = p - part.corners[i];
        if (edge.x() * to.y() - edge.y() * to.x() < -1e-9) return false;
      }
      return true;
    });
  };
  for (const RobotShape& shape : shapes()) {
    const std::vector<OutlinePart> outline = ground_outline(shape);
    const double inscribed = inscribed_radius(shape);
    EXPECT_LE(inscribed, circumscribed_radius(shape) + 1e-12);
    for (int k = 0; k < 64; ++k) {
      const double a = k * M_PI / 32.0;
      EXPECT_TRUE(inscribed == 0.0 ||
                  in_outline(outline, inscribed * Eigen::Vector2d(std::cos(a), std::sin(a))));
    }
    for (const OutlinePart& part : outline) {
      for (const Eigen::Vector2d& c : part.corners) {
        EXPECT_LE(c.norm() + part.radius, circumscribed_radius(shape) + 1e-9);
      }
    }
  }
  const BoxShape box{{0.1, 0.05, 0.3}, {0.9, 0.5, 0.4}};
  EXPECT_NEAR(inscribed_radius(box), 0.2, 1e-12);
  EXPECT_TRUE(in_outline(ground_outline(box), {0.549, 0.299}));
  EXPECT_FALSE(in_outline(ground_outline(box), {0.551, 0.0}));
  EXPECT_FALSE(in_outline(ground_outline(box), {0.0, -0.201}));
  EXPECT_EQ(inscribed_radius(CylinderShape{{0.3, 0.0, 0.2}, 0.2, 0.4}), 0.0);
  EXPECT_NEAR(inscribed_radius(SphereSetShape{{{{0.3, 0, 0}, 0.2}, {{0.0, 0.1, 0}, 0.4}}}), 0.3,
              1e-12);
}

TEST_F(RobotShapes, RoundIsWhoseHeadingMakesNoDifference) {
  EXPECT_TRUE(is_round(CylinderShape{}));
  EXPECT_TRUE(is_round(SphereSetShape{{{{0, 0, 0.2}, 0.2}, {{0.05, 0, 0.5}, 0.1}}}));
  EXPECT_FALSE(is_round(CylinderShape{{0.05, 0.0, 0.2}, 0.2, 0.4}));
  EXPECT_FALSE(is_round(BoxShape{{0, 0, 0.3}, {0.4, 0.4, 0.4}}));
  EXPECT_FALSE(is_round(SphereSetShape{{{{0.2, 0, 0}, 0.2}, {{-0.2, 0, 0}, 0.2}}}));
}

TEST_F(RobotShapes, TheSameShapeGivesTheSameBits) {
  for (const RobotShape& shape : shapes()) {
    const auto a = bounding_discs(shape), b = bounding_discs(shape);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].center, b[i].center);
      EXPECT_EQ(a[i].radius, b[i].radius);
    }
  }
}

std::string error_of(const RobotShape& shape) {
  try {
    validate(shape);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(RobotShapes, DegenerateShapesAreRefusedByEveryFunction) {
  using testing::HasSubstr;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<RobotShape, std::string>> bad = {
      {SphereSetShape{}, "sphere set is empty"},
      {SphereSetShape{{{{0, 0, 0}, 0.0}}}, "radius is 0"},
      {SphereSetShape{{{{0, 0, 0}, 0.1}, {{0, nan, 0}, 0.1}}}, "center is nan"},
      {BoxShape{{0, 0, 0}, {0.4, -0.3, 0.3}}, "size is -0.3"},
      {BoxShape{{0, 0, 0}, {0.4, 0.3, infinity}}, "size is inf"},
      {BoxShape{{0, nan, 0}, {0.4, 0.3, 0.3}}, "center is nan"},
      {CylinderShape{{0, 0, 0}, 0.0, 0.4}, "radius is 0"},
      {CylinderShape{{0, 0, 0}, 0.2, nan}, "height is nan"},
      {ConvexShape{}, "number of vertices is 0; expected at least 4"},
      {ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, "number of vertices is 3"},
      {ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}}, "thickness is"},
      {ConvexShape{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}}, "thickness is"},
      {ConvexShape{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}, "thickness is"},
      {ConvexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, nan}}}, "vertex is nan"}};
  for (const auto& [shape, message] : bad) {
    EXPECT_THAT(error_of(shape), HasSubstr(message));
    EXPECT_THAT(error_of(shape), HasSubstr("expected"));
    EXPECT_THROW(vertical_extent(shape), std::invalid_argument);
    EXPECT_THROW(bounding_discs(shape), std::invalid_argument);
    EXPECT_THROW(bounding_spheres(shape), std::invalid_argument);
    EXPECT_THROW(circumscribed_radius(shape), std::invalid_argument);
    EXPECT_THROW(ground_outline(shape), std::invalid_argument);
    EXPECT_THROW(inscribed_radius(shape), std::invalid_argument);
    EXPECT_THROW(is_round(shape), std::invalid_argument);
  }
  for (const RobotShape& shape : shapes()) EXPECT_EQ(error_of(shape), "no error");
  EXPECT_THROW(bounding_discs(BoxShape{}, 0.0), std::invalid_argument);
  EXPECT_THROW(bounding_spheres(BoxShape{}, nan), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::robot_shape_test
