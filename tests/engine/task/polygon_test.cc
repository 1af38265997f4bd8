// SPDX-License-Identifier: Apache-2.0
#include "engine/task/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace prospect::polygon_test {
namespace {

const Polygon kSquare = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
// Not convex: a U that opens upward.
const Polygon kU = {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};

TEST(Polygon, FaultsAreNamed) {
  EXPECT_EQ(polygon_fault(kSquare), "");
  EXPECT_EQ(polygon_fault(kU), "");
  EXPECT_EQ(polygon_fault(Polygon(kU.rbegin(), kU.rend())), "") << "in either sense";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<Polygon, std::string>> table = {
      {{}, "0 corners"},
      {{{0, 0}, {1, 1}}, "2 corners"},
      {Polygon(1001, Eigen::Vector2d::Zero()), "1001 corners"},
      {{{0, 0}, {1, nan}, {1, 1}}, "corner 2 is not finite"},
      {{{0, 0}, {1, 0}, {1, 2e6}}, "corner 3 is not finite or beyond"},
      {{{0, 0}, {1, 0}, {1, 0}, {0, 1}}, "corners 2 and 3 are the same"},
      {{{0, 0}, {1, 0}, {1, 1}, {0, 0}}, "corners 4 and 1 are the same"},
      {{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, "sides 1 and 3 meet"},
      {{{0, 0}, {2, 0}, {1, 0}, {1, 1}}, "sides 1 and 2 meet"},
      // A corner that touches another side.
      {{{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}, "meet"},
      {{{0, 0}, {1, 0}, {2, 0}}, "sides"},
  };
  for (const auto& [polygon, expected] : table) {
    const std::string fault = polygon_fault(polygon);
    EXPECT_NE(fault.find(expected), std::string::npos) << fault << " for " << expected;
    EXPECT_NE(fault.find("expected"), std::string::npos) << fault;
    EXPECT_EQ(fault.find('\n'), std::string::npos);
  }
}

/// The least distance to a million points of the boundary, or so.
double slow_distance(const Polygon& polygon, const Eigen::Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    for (int k = 0; k <= 2000; ++k) least = std::min(least, (a + (b - a) * k / 2000.0 - p).norm());
  }
  return least;
}

TEST(Polygon, DistanceAndSideAgreeWithSampling) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-1.0, 4.0);
  int inside = 0;
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector2d p(place(random), place(random));
    const double d = signed_distance(kU, p);
    ASSERT_NEAR(std::abs(d), slow_distance(kU, p), 1e-3);
    const bool in =
        p.x() > 0 && p.x() < 3 && p.y() > 0 && p.y() < 3 && !(p.x() > 1 && p.x() < 2 && p.y() > 1);
    ASSERT_EQ(d < 0.0, in) << p.transpose();
    ASSERT_EQ(contains(kU, p), in);
    inside += in;
  }
  EXPECT_GT(inside, 50);
  EXPECT_EQ(area(kU), 7.0);
  EXPECT_EQ(area(Polygon(kU.rbegin(), kU.rend())), 7.0);
}

TEST(Polygon, DistancesOfSegments) {
  EXPECT_EQ(segment_distance({0, 0}, {2, 0}, {1, -1}, {1, 1}), 0.0) << "they cross";
  EXPECT_EQ(segment_distance({0, 0}, {2, 0}, {2, 0}, {3, 1}), 0.0) << "they touch";
  EXPECT_EQ(segment_distance({0, 0}, {2, 0}, {1, 0}, {3, 0}), 0.0) << "one line, overlapping";
  EXPECT_EQ(segment_distance({0, 0}, {2, 0}, {3, 0}, {4, 0}), 1.0) << "one line, apart";
  EXPECT_EQ(segment_distance({0, 0}, {2, 0}, {0, 1}, {2, 1}), 1.0);
  EXPECT_NEAR(segment_distance({0, 0}, {1, 0}, {2, 1}, {2, 5}), std::sqrt(2.0), 1e-15);
}

// Against what lies on either side, at random points.
TEST(Polygon, ClippedIsWhatLiesOnOneSide) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1.0, 4.0);
  for (const Eigen::Vector2d& normal :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, -1), Eigen::Vector2d(0.6, 0.8)}) {
    for (const double offset : {-2.0, 0.7, 1.5, 2.5}) {
      const Polygon kept = clipped(kU, normal, offset);
      for (int n = 0; n < 300; ++n) {
        const Eigen::Vector2d p(u(random), u(random));
        if (std::abs(normal.dot(p) - offset) < 1e-6) continue;
        const bool inside = contains(kU, p) && normal.dot(p) > offset;
        EXPECT_EQ(!kept.empty() && contains(kept, p), inside) << p.transpose();
      }
    }
    EXPECT_TRUE(clipped(kU, normal, 10.0).empty());
  }
}

}  // namespace
}  // namespace prospect::polygon_test
