// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/planar_error.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace prospect::planar_error_test {
namespace {

const Eigen::Matrix3d P =
    (Eigen::Matrix3d() << 0.04, 0.01, 0.006, 0.01, 0.09, -0.004, 0.006, -0.004, 0.0025).finished();
const Eigen::Vector2d kLever(2.0, -3.0);

TEST(PlanarError, IsThatOfDrawnPoses) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d L = P.llt().matrixL();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kDrawn = 200000;
  for (int n = 0; n < kDrawn; ++n) {
    const Eigen::Vector3d e = L * Eigen::Vector3d(normal(random), normal(random), normal(random));
    Eigen::Vector3d at;
    at << e.head<2>() + e[2] * Eigen::Vector2d(-kLever.y(), kLever.x()), e[2];
    sum += at * at.transpose() / kDrawn;
  }
  EXPECT_TRUE(carried(P, kLever).isApprox(sum, 0.02)) << sum;
  EXPECT_NEAR(place_variance(P, kLever), 0.5 * (sum(0, 0) + sum(1, 1)), 0.02 * sum(0, 0));
}

TEST(PlanarError, WhatWasAddedIsWhatIsBeyondWhatWasCarried) {
  const Eigen::Matrix3d more = Eigen::Vector3d(0.01, 0.02, 0.001).asDiagonal();
  EXPECT_TRUE(added(P, kLever, carried(P, kLever) + more).isApprox(more, 1e-9));
  // Found again, it knows its place better: nothing was added, not less than nothing.
  EXPECT_TRUE(added(P, kLever, carried(P, kLever) - 0.1 * more).isZero(1e-12));
}

}  // namespace
}  // namespace prospect::planar_error_test
