// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/polygon_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace prospect::polygon_triangles_test {
namespace {

Ring box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Ring turned(Ring ring, double angle) {
  for (Eigen::Vector2d& p : ring) p = Eigen::Rotation2Dd(angle) * p;
  return ring;
}

/// The area of the triangles; each runs to the left, and none covers the middle of a hole.
double covered(const Ring& outer, const std::vector<Ring>& holes) {
  Ring all = outer;
  for (const Ring& hole : holes) all.insert(all.end(), hole.begin(), hole.end());
  double area = 0.0;
  for (const auto& [a, b, c] : polygon_triangles(outer, holes)) {
    const Ring triangle{all.at(a), all.at(b), all.at(c)};
    EXPECT_GE(doubled_area(triangle), -1e-12);
    area += 0.5 * doubled_area(triangle);
    for (const Ring& hole : holes) {
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& p : hole) middle += p / static_cast<double>(hole.size());
      EXPECT_FALSE(is_within(middle, triangle));
    }
  }
  return area;
}

TEST(PolygonTriangles, CoverWhatLiesBetweenAPolygonAndItsHoles) {
  const Ring notched{{0, 0}, {6, 0}, {6, 4}, {3, 1}, {0, 4}};
  EXPECT_NEAR(covered(notched, {}), 15.0, 1e-9);
  std::vector<Ring> windows;
  for (int n = 0; n < 5; ++n) windows.push_back(box(1 + 2 * n, 1, 2 + 2 * n, 2));
  for (int n = 0; n < 4; ++n) windows.push_back(box(1.5 + 2 * n, 2.5, 2.5 + 2 * n, 3.5));
  // Whichever way round, and at any angle, where nothing is level.
  for (int turn = 0; turn < 12; ++turn) {
    const double angle = 2.0 * std::numbers::pi * turn / 12.0;
    Ring outer = turned(box(0, 0, 11, 4), angle);
    std::vector<Ring> holes;
    for (const Ring& window : windows) holes.push_back(turned(window, angle));
    if (turn % 2 == 1) std::reverse(outer.begin(), outer.end());
    if (turn % 3 == 1) std::reverse(holes[2].begin(), holes[2].end());
    EXPECT_NEAR(covered(outer, holes), 44.0 - 9.0, 1e-9) << turn;
  }
}

TEST(PolygonTriangles, AHoleOutsideIsNone) {
  EXPECT_NEAR(covered(box(0, 0, 2, 2), {box(5, 5, 6, 6)}), 4.0, 1e-9);
  EXPECT_TRUE(polygon_triangles({{0, 0}, {1, 1}}).empty());
}

}  // namespace
}  // namespace prospect::polygon_triangles_test
