// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/cost_to_go.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace prospect::cost_to_go_test {
namespace {

CostToGo random_field(std::mt19937_64& random, int n = 24) {
  const GridFrame frame{0.1, -7, 5, n, n};
  Grid<double> seconds(frame, 0.0);
  std::uniform_real_distribution<double> draw(-2.0, 20.0);
  for (double& v : seconds.data) v = draw(random);
  return CostToGo(seconds, Grid<std::uint8_t>(frame, 1), 0.6);
}

// The sum over all cells of the uniform cubic B-spline, by its piecewise definition.
double slow_value(const CostToGo& v, double x, double y) {
  const auto spline = [](double t) {
    t = std::abs(t);
    if (t >= 2.0) return 0.0;
    if (t >= 1.0) return std::pow(2.0 - t, 3) / 6.0;
    return 2.0 / 3.0 - t * t + 0.5 * t * t * t;
  };
  double sum = 0.0;
  const GridFrame& f = v.frame();
  for (int j = f.j0 - 6; j < f.j0 + f.height + 6; ++j) {
    for (int i = f.i0 - 6; i < f.i0 + f.width + 6; ++i) {
      const Cell c{std::clamp(i, f.i0, f.i0 + f.width - 1),
                   std::clamp(j, f.j0, f.j0 + f.height - 1)};
      sum += spline(x / f.resolution - i - 0.5) * spline(y / f.resolution - j - 0.5) * v.cells()[c];
    }
  }
  return sum;
}

TEST(CostToGo, IsTheSplineOfTheCellsWithExactDerivatives) {
  std::mt19937_64 random(1);
  const CostToGo v = random_field(random);
  std::uniform_real_distribution<double> x(-0.95, 1.95),
      y(0.25, 3.15);  // 0.25 m beyond the rim, too
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector2d p(x(random), y(random));
    Eigen::Vector2d g, g1;
    Eigen::Matrix2d h;
    const double value = v.value(p, g, h);
    ASSERT_NEAR(value, slow_value(v, p.x(), p.y()), 1e-10);
    ASSERT_EQ(value, v.value(p));
    ASSERT_EQ(value, v.value(p, g1));
    ASSERT_EQ(g, g1);
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d d = kStep * Eigen::Vector2d::Unit(axis);
      Eigen::Vector2d up, down;
      const double difference = v.value(p + d, up) - v.value(p - d, down);
      ASSERT_NEAR(difference / (2 * kStep), g[axis], 1e-4);
      ASSERT_NEAR((up - down)[0] / (2 * kStep), h(axis, 0), 2e-2);  // values up to 5e3
      ASSERT_NEAR((up - down)[1] / (2 * kStep), h(axis, 1), 2e-2);
    }
  }
}

TEST(CostToGo, IsTwiceContinuousAcrossCellsAndTheRim) {
  std::mt19937_64 random(2);
  const CostToGo v = random_field(random);
  for (int k = -12; k < 24; ++k) {
    for (const double along : {0.333, 0.85, 1.21}) {
      // Pieces of the spline meet where x / r + 1/2 is whole.
      const double x = (k + 0.5) * 0.1;
      Eigen::Vector2d ga, gb;
      Eigen::Matrix2d ha, hb;
      const double a = v.value({x - 1e-9, along}, ga, ha);
      const double b = v.value({x + 1e-9, along}, gb, hb);
      EXPECT_NEAR(a, b, 1e-6);
      EXPECT_NEAR((ga - gb).norm(), 0.0, 1e-4);
      EXPECT_NEAR((ha - hb).norm(), 0.0, 1e-2);
    }
  }
}

TEST(CostToGo, StaysBetweenItsCellsAndIsFiniteEverywhere) {
  std::mt19937_64 random(3);
  const CostToGo v = random_field(random);
  const auto [low, high] = std::minmax_element(v.cells().data.begin(), v.cells().data.end());
  for (const double scale : {0.1, 1.0, 10.0, 1e6, 1e300}) {
    for (int k = 0; k < 100; ++k) {
      std::uniform_real_distribution<double> draw(-scale, scale);
      Eigen::Vector2d g;
      Eigen::Matrix2d h;
      const double value = v.value({draw(random), draw(random)}, g, h);
      EXPECT_GE(value, *low - 1e-9);
      EXPECT_LE(value, *high + 1e-9);
      EXPECT_TRUE(g.allFinite() && h.allFinite());
    }
  }
  EXPECT_TRUE(std::isnan(v.value(std::nan(""), 0.0)));
  EXPECT_TRUE(std::isnan(v.value(0.0, std::numeric_limits<double>::infinity())));
  const CostToGo none;
  EXPECT_EQ(none.value(3.0, 4.0), 0.0);
  EXPECT_EQ(none.descend({1.0, 1.0}, 5.0).size(), 1u);
}

// Distance to a point round a wall, so that the path down must turn a corner.
CostToGo around_a_wall() {
  const GridFrame frame{0.1, 0, 0, 60, 60};
  Grid<double> seconds(frame, 0.0);
  Grid<std::uint8_t> reached(frame, 1);
  for (int k = 0; k < frame.size(); ++k) {
    const Cell c = frame.at(k);
    const bool wall = c.i >= 28 && c.i < 32 && c.j < 40;
    reached[c] = wall ? 0 : 1;
    const Eigen::Vector2d p = frame.center(c), goal(5.05, 1.05), near(3.2, 4.0), far(2.8, 4.0);
    // The exact length of the shortest way round the wall's end.
    const double crossing = p.y() + (goal.y() - p.y()) * (near.x() - p.x()) / (goal.x() - p.x());
    if (p.x() > near.x() || crossing > near.y()) {
      seconds[c] = (p - goal).norm();
    } else if (p.y() > near.y()) {
      seconds[c] = (p - near).norm() + (near - goal).norm();
    } else {
      seconds[c] = (p - far).norm() + (far - near).norm() + (near - goal).norm();
    }
    if (wall) seconds[c] += 2.0;
  }
  return CostToGo(seconds, reached, 1.0);
}

TEST(CostToGo, DescendsInsideReachedCellsToTheViewpoint) {
  const CostToGo v = around_a_wall();
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> draw(0.3, 5.7);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d p(draw(random), draw(random));
    const auto path = v.descend(p, 50.0);
    ASSERT_EQ(path.front(), p);
    ASSERT_LT((path.back() - Eigen::Vector2d(5.05, 1.05)).norm(), 0.15);
    double length = 0.0;
    bool inside = v.reached(v.frame().cell(p.x(), p.y()));
    for (std::size_t m = 1; m < path.size(); ++m) {
      length += (path[m] - path[m - 1]).norm();
      ASSERT_LE((path[m] - path[m - 1]).norm(), 0.05 + 1e-9);
      const bool now = v.reached(v.frame().cell(path[m].x(), path[m].y()));
      ASSERT_TRUE(now || !inside);  // once in, never out
      inside = now;
    }
    if (v.reached(v.frame().cell(p.x(), p.y()))) {
      EXPECT_LT(length, 1.1 * v.value(p) + 0.3);
    }
    const auto cut = v.descend(p, 0.5);
    double cut_length = 0.0;
    for (std::size_t m = 1; m < cut.size(); ++m) cut_length += (cut[m] - cut[m - 1]).norm();
    EXPECT_LT(cut_length, 0.55 + 1e-9);
  }
  EXPECT_TRUE(v.descend({std::nan(""), 0.0}, 1.0).empty());
}

TEST(CostToGo, RefusesBadCells) {
  const GridFrame frame{0.1, 0, 0, 4, 4};
  Grid<double> bad(frame, 0.0);
  bad.data[3] = std::nan("");
  EXPECT_THROW(CostToGo(bad, Grid<std::uint8_t>(frame, 1), 1.0), std::invalid_argument);
  EXPECT_THROW(
      CostToGo(Grid<double>(frame, 0.0), Grid<std::uint8_t>(GridFrame{0.1, 1, 0, 4, 4}, 1), 1.0),
      std::invalid_argument);
  EXPECT_THROW(CostToGo(Grid<double>(frame, 0.0), Grid<std::uint8_t>(frame, 1), 0.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::cost_to_go_test
