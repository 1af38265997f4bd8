// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/pose_consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "engine/support/cholesky.h"

namespace prospect::pose_consistency_test {
namespace {

/// Normalised errors of Gaussian errors whose covariance is `factor` times the claimed one.
std::vector<double> normalised(double factor, int degrees) {
  std::mt19937 generator(2);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd A(degrees, degrees);
  for (double& a : A.reshaped()) a = normal(generator);
  const Eigen::MatrixXd covariance =
      A * A.transpose() + 0.1 * Eigen::MatrixXd::Identity(degrees, degrees);
  const Eigen::MatrixXd root = covariance.llt().matrixL();
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i) {
    Eigen::VectorXd z(degrees);
    for (double& x : z) x = normal(generator);
    values.push_back(normalised_error_squared(std::sqrt(factor) * root * z, covariance));
  }
  return values;
}

TEST(PoseConsistency, OfTrueCovariancesItIsOne) {
  for (int degrees = 1; degrees <= 6; ++degrees) {
    const PoseConsistency c = pose_consistency(normalised(1.0, degrees), degrees);
    EXPECT_EQ(c.count, 20000);
    EXPECT_NEAR(c.mean, 1.0, 0.05) << degrees;
    EXPECT_NEAR(c.median, 1.0, 0.05) << degrees;
    EXPECT_NEAR(c.within_95, 0.95, 0.01) << degrees;
  }
}

TEST(PoseConsistency, WrongCovariancesAreSeen) {
  const PoseConsistency sure = pose_consistency(normalised(4.0, 6), 6);
  EXPECT_NEAR(sure.mean, 4.0, 0.2);
  EXPECT_LT(sure.within_95, 0.4);
  const PoseConsistency shy = pose_consistency(normalised(0.25, 6), 6);
  EXPECT_NEAR(shy.mean, 0.25, 0.02);
  EXPECT_GT(shy.within_95, 0.999);
}

TEST(PoseConsistency, WhatHasNoCovarianceIsLeftOut) {
  const Eigen::VectorXd error = Eigen::VectorXd::Ones(2);
  const double none = normalised_error_squared(error, Eigen::MatrixXd::Zero(2, 2));
  EXPECT_TRUE(std::isnan(none));
  EXPECT_TRUE(
      std::isnan(normalised_error_squared(error, Eigen::MatrixXd::Constant(2, 2, INFINITY))));
  EXPECT_EQ(pose_consistency({none, 1.0}, 2).count, 1);
  EXPECT_EQ(pose_consistency({}, 6).count, 0);
  EXPECT_THROW(pose_consistency({}, 7), std::invalid_argument);
  EXPECT_THROW(pose_consistency({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::pose_consistency_test
