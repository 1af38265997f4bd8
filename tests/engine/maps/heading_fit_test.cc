// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/heading_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/not_under_sanitizers.h"

namespace prospect::heading_fit_test {
namespace {

BoxShape box(double length, double width, const Eigen::Vector2d& center = {0.0, 0.0}) {
  return {{center.x(), center.y(), 0.3}, {length, width, 0.4}};
}

/// Whether a box at a pose and a square overlap: then points of the outline of one lie inside the
/// other, or its centre does.
bool overlap(const BoxShape& b, const Eigen::Vector2d& position, double yaw,
             const Eigen::Vector2d& low, double side) {
  constexpr int kPoints = 400;  // an edge
  const Eigen::Rotation2Dd turn(yaw);
  const Eigen::Vector2d half = 0.5 * b.size.head<2>();
  const auto inside = [](const Eigen::Vector2d& p, const Eigen::Vector2d& h) {
    return (h.array() - p.array().abs()).minCoeff() > 0.0;
  };
  const Eigen::Vector2d middle = low + Eigen::Vector2d::Constant(0.5 * side);
  const Eigen::Vector2d half_side = Eigen::Vector2d::Constant(0.5 * side);
  const auto to_world = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return position + turn * Eigen::Vector2d(b.center.head<2>() + p);
  };
  const auto to_box = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return turn.inverse() * Eigen::Vector2d(p - position) - b.center.head<2>();
  };
  for (int n = -kPoints; n <= kPoints; ++n) {
    const double s = 1.0 * n / kPoints;
    for (const Eigen::Vector2d& p :
         {Eigen::Vector2d(s, 1.0), Eigen::Vector2d(s, -1.0), Eigen::Vector2d(1.0, s),
          Eigen::Vector2d(-1.0, s), Eigen::Vector2d(0.0, 0.0)}) {
      if (inside(to_world(p.cwiseProduct(half)) - middle, half_side)) return true;
      if (inside(to_box(middle + 0.5 * side * p), half)) return true;
    }
  }
  return false;
}

TEST(HeadingFit, HeadingsGoRoundOnce) {
  EXPECT_EQ(heading_at(0), 0.0);
  EXPECT_NEAR(heading_at(16), M_PI / 2.0, 1e-12);
  for (int k = 0; k < kHeadings; ++k) {
    for (const double off : {-0.04, 0.0, 0.04}) {
      for (const double turns : {-4.0 * M_PI, 0.0, 2.0 * M_PI}) {
        EXPECT_EQ(nearest_heading(heading_at(k) + off + turns), k);
      }
    }
  }
}

// The distance is how far the box may be moved towards the square, or must be moved away from it:
// judged by points of the box.
TEST(HeadingFit, DistanceOfABoxIsTheWayUntilItTouches) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int apart = 0, inside = 0;
  for (int n = 0; n < 100; ++n) {
    const BoxShape b = box(0.6 + 0.3 * u(random), 0.3 + 0.1 * u(random), {0.2 * u(random), 0.0});
    const Eigen::Vector2d position(0.6 * u(random), 0.6 * u(random));
    const double yaw = 3.0 * u(random);
    const Eigen::Vector2d low(-0.1, -0.1);
    const double d = outline_distance(ground_outline(b), position, yaw, low, 0.2);
    if (std::abs(d) < 0.01) continue;
    EXPECT_EQ(overlap(b, position, yaw, low, 0.2), d < 0.0);
    ++(d < 0.0 ? inside : apart);
    bool touched = false, parted = false;
    for (int k = 0; k < 180; ++k) {
      const Eigen::Vector2d path(std::cos(k * M_PI / 90.0), std::sin(k * M_PI / 90.0));
      const auto at = [&](double s) { return overlap(b, position + s * path, yaw, low, 0.2); };
      if (d > 0.0) {
        EXPECT_FALSE(at(d - 0.002));
        touched = touched || at(d + 0.004);
      } else {
        EXPECT_TRUE(at(-d - 0.004));
        parted = parted || !at(-d + 0.003);
      }
      if (touched || parted) break;
    }
    EXPECT_TRUE(touched || parted) << d;
  }
  EXPECT_GT(apart, 10);
  EXPECT_GT(inside, 10);
}

TEST(HeadingFit, DiscsAreMeasuredFromTheirCentre) {
  const auto outline = ground_outline(CylinderShape{{0.3, 0.0, 0.2}, 0.2, 0.4});
  const Eigen::Vector2d low(1.0, -0.05);
  EXPECT_NEAR(outline_distance(outline, {0.0, 0.0}, 0.0, low, 0.1), 0.5, 1e-12);
  EXPECT_NEAR(outline_distance(outline, {0.0, 0.0}, M_PI, low, 0.1), 1.1, 1e-12);
  EXPECT_NEAR(outline_distance(outline, {0.65, 0.0}, 0.0, low, 0.1), -0.15, 1e-12);
  // Of several parts the nearest counts.
  const auto pair = ground_outline(SphereSetShape{{{{0.3, 0, 0}, 0.2}, {{-0.3, 0, 0}, 0.1}}});
  EXPECT_NEAR(outline_distance(pair, {0.0, 0.0}, M_PI, low, 0.1), 0.6, 1e-12);
}

TEST(HeadingFit, OfARoundBodyIsTheRuleOfRadii) {
  for (const double room : {0.0, 0.05, -0.1}) {
    const HeadingFit fit(CylinderShape{{0, 0, 0.2}, 0.21, 0.4}, room, 0.1);
    std::size_t near = 0;
    for (int di = -6; di <= 6; ++di) {
      for (int dj = -6; dj <= 6; ++dj) {
        const double d =
            0.1 * std::hypot(std::max(0.0, std::abs(di) - 0.5), std::max(0.0, std::abs(dj) - 0.5));
        near += d < 0.21 + room;
      }
    }
    ASSERT_EQ(fit.entries().size(), near);
    for (const HeadingFit::Entry& e : fit.entries()) EXPECT_EQ(e.bars, kAllHeadings);
  }
}

TEST(HeadingFit, ALongBodyFitsLengthwaysBetweenWalls) {
  // Walls whose faces are 0.35 m to either side of a row of cells, 0.7 m apart.
  const HeadingFit fit(box(0.9, 0.5), 0.02, 0.1);
  HeadingMask barred = kNoHeading;
  for (const HeadingFit::Entry& e : fit.entries()) {
    EXPECT_LE(std::max(std::abs(e.di), std::abs(e.dj)), fit.reach());
    if (std::abs(e.dj) >= 4) barred |= e.bars;
  }
  for (int k = 0; k < kHeadings; ++k) {
    const double s = std::abs(std::sin(heading_at(k))), c = std::abs(std::cos(heading_at(k)));
    const bool fits = 0.45 * s + 0.25 * c + 0.02 <= 0.35;
    EXPECT_EQ(((~barred >> k) & 1U) != 0, fits) << k;
  }
  EXPECT_EQ(barred & 1U, 0U);
  EXPECT_NE(barred & (HeadingMask{1} << 16), 0U);
}

TEST(HeadingFit, RefusesWhatIsNoNumber) {
  EXPECT_THROW(HeadingFit(box(0.9, 0.5), std::nan(""), 0.1), std::invalid_argument);
  EXPECT_THROW(HeadingFit(box(0.9, 0.5), 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(HeadingFit(box(0.9, -0.5), 0.0, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::heading_fit_test
