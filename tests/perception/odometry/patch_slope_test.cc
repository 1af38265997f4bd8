// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/patch_slope.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "perception/odometry/patch_alignment.h"

namespace prospect::patch_slope_test {
namespace {

/// A smooth texture of the left image, aperiodic and steeper to the right: where a patch of it is
/// mismatched, what is below does not make good what is above.
double texture(double x, double y) {
  return 120.0 + 30.0 * std::sin(0.31 * x + 0.12 * y) + 25.0 * std::sin(0.23 * y - 0.17 * x + 1.0) +
         (15.0 + 0.2 * x) * std::sin(0.55 * x - 0.4 * y);
}

constexpr int kWidth = 160, kHeight = 120;
const Eigen::Vector2f kCentre(80.0f, 60.0f);
constexpr double kDisparity = 12.3;  // at the centre [px]

struct Pair {
  ImagePyramid left, right;
};

/// What a plane shows whose disparity is kDisparity + g . (x - kCentre).
Pair plane(const Eigen::Vector2d& g) {
  const auto grey = [](double x, double y) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(texture(x, y), 0.0, 255.0)));
  };
  Image left(kWidth, kHeight), right(kWidth, kHeight);
  const Eigen::Vector2d c = kCentre.cast<double>();
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      left.at(u, v) = grey(u, v);
      // u = x - d(x, v), solved for x.
      const double x = (u + kDisparity - g.x() * c.x() + g.y() * (v - c.y())) / (1.0 - g.x());
      right.at(u, v) = grey(x, v);
    }
  }
  return {ImagePyramid(left.view(), 1), ImagePyramid(right.view(), 1)};
}

struct Found {
  std::optional<SlantedPatch> slanted;
  double facing = 0.0;  ///< disparity of the patch that faces the camera
};
Found align(const Pair& pair) {
  const auto patch = Patch::make(pair.left.level(0), kCentre, Eigen::Matrix2f::Identity(), 0.5f);
  const Eigen::Vector2f start = kCentre - Eigen::Vector2f(kDisparity, 0.0f);
  const auto facing = patch->align(pair.right.level(0), start, 2.5f);
  EXPECT_TRUE(facing.converged);
  return {align_slanted(pair.left.level(0), kCentre, pair.right.level(0), facing.position,
                        facing.residual, 2.5f),
          kCentre.x() - facing.position.x()};
}

TEST(PatchSlope, IsThatOfThePlaneAndMakesTheDisparityRight) {
  double bias = 0.0;
  for (const Eigen::Vector2d& g :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.0, 0.27), Eigen::Vector2d(0.25, 0.0),
        Eigen::Vector2d(-0.2, 0.15), Eigen::Vector2d(0.1, -0.3)}) {
    const Found found = align(plane(g));
    ASSERT_TRUE(found.slanted) << g.transpose();
    EXPECT_LT((found.slanted->slope.cast<double>() - g).norm(), 0.03) << g.transpose();
    EXPECT_NEAR(kCentre.x() - found.slanted->right.x(), kDisparity, 0.03) << g.transpose();
    EXPECT_NEAR(found.slanted->right.y(), kCentre.y(), 0.05);
    bias = std::max(bias, std::abs(found.facing - kDisparity));
  }
  EXPECT_GT(bias, 0.1) << "these planes are none that need it";
}

TEST(PatchSlope, IsBelievedByWhatTheResidualLeavesOfIt) {
  const Pair pair = plane({0.0, 0.27});
  const auto slope = [&](float residual) {
    const auto found = align_slanted(pair.left.level(0), kCentre, pair.right.level(0),
                                     kCentre - Eigen::Vector2f(kDisparity, 0.0f), residual, 2.5f);
    EXPECT_TRUE(found) << residual;
    return found ? found->slope.y() : 0.0f;
  };
  EXPECT_NEAR(slope(0.0f), 0.27f, 0.02f);
  EXPECT_NEAR(slope(1e6f), 0.0f, 0.02f);  // grey levels that differ by a thousand tell nothing
}

TEST(PatchSlope, RefusesWhatLeavesTheImageOrIsNotThere) {
  const Pair pair = plane({0.0, 0.2});
  const PyramidLevel &left = pair.left.level(0), &right = pair.right.level(0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Vector2f start = kCentre - Eigen::Vector2f(kDisparity, 0.0f);
  EXPECT_TRUE(align_slanted(left, kCentre, right, start, 1.0f, 2.5f));
  for (const Eigen::Vector2f& c : {Eigen::Vector2f(3, 60), Eigen::Vector2f(nan, 60),
                                   Eigen::Vector2f(80, 118), Eigen::Vector2f(1e30f, 60)}) {
    EXPECT_FALSE(align_slanted(left, c, right, start, 1.0f, 2.5f));
    EXPECT_FALSE(align_slanted(left, kCentre, right, c, 1.0f, 2.5f));
  }
  EXPECT_FALSE(align_slanted(left, kCentre, right, start + Eigen::Vector2f(2, 0), 1.0f, 0.5f))
      << "farther than max_shift";
  const ImagePyramid blank(Image(kWidth, kHeight, 90).view(), 1);
  EXPECT_FALSE(align_slanted(left, kCentre, blank.level(0), start, 1.0f, 2.5f));
}

}  // namespace
}  // namespace prospect::patch_slope_test
