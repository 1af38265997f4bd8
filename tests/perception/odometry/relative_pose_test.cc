// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/relative_pose.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "perception/odometry/se3.h"

namespace prospect::relative_pose_test {
namespace {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  Vector6d tangent(double t, double w) {
    Vector6d xi;
    for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? t : w) * normal_(generator_);
    return xi;
  }
  Matrix6d information() {
    Matrix6d A;
    for (int k = 0; k < 6; ++k) A.col(k) = tangent(1.0, 1.0);
    return A * A.transpose() + Matrix6d::Identity();
  }

 private:
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
};

TEST(RelativePose, DerivativesOfTheErrorAreThoseOfDifferences) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Isometry3d T_a = exp_se3(random.tangent(5.0, 1.0)), T = exp_se3(random.tangent(3.0, 0.7));
    const Isometry3d T_b = T_a * T * exp_se3(random.tangent(1.0, 0.5));
    Matrix6d by_a, by_b;
    measurement_error(T_a, T_b, T, &by_a, &by_b);
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-5;
      const Vector6d step = kStep * Vector6d::Unit(k);
      const Isometry3d forth = exp_se3(step), back = exp_se3(-step);
      const Vector6d of_a =
          (measurement_error(T_a * forth, T_b, T) - measurement_error(T_a * back, T_b, T)) /
          (2.0 * kStep);
      const Vector6d of_b =
          (measurement_error(T_a, T_b * forth, T) - measurement_error(T_a, T_b * back, T)) /
          (2.0 * kStep);
      EXPECT_LT((by_a.col(k) - of_a).norm(), 1e-7);
      EXPECT_LT((by_b.col(k) - of_b).norm(), 1e-7);
    }
  }
}

TEST(RelativePose, TheErrorIsTheNoiseToFirstOrder) {
  Random random(2);
  const Isometry3d T_a = exp_se3(random.tangent(5.0, 1.0)), T = exp_se3(random.tangent(3.0, 0.7));
  const Vector6d n = random.tangent(1e-4, 1e-4);
  EXPECT_LT((measurement_error(T_a, T_a * T * exp_se3(n), T) - n).norm(), 1e-7);
}

TEST(RelativePose, FromTheOtherEndItIsAsSure) {
  Random random(3);
  const RelativePose measured = {exp_se3(random.tangent(3.0, 0.7)), random.information()};
  const RelativePose back = inverse(measured);
  const Isometry3d T_a = exp_se3(random.tangent(5.0, 1.0));
  const Isometry3d T_b = T_a * measured.T * exp_se3(random.tangent(1e-5, 1e-5));
  const Vector6d e = measurement_error(T_a, T_b, measured.T);
  const Vector6d e_back = measurement_error(T_b, T_a, back.T);
  const double chi2 = e.dot(measured.information * e);
  EXPECT_NEAR(e_back.dot(back.information * e_back), chi2, 1e-4 * chi2);
}

TEST(RelativePose, WhatIsNoInformation) {
  const Matrix6d I = Matrix6d::Identity();
  EXPECT_TRUE(is_information(I));
  EXPECT_TRUE(is_information(Random(4).information()));
  Matrix6d nan = I, endless = I, singular = I, negative = I, skewed = I, tiny = I;
  nan(2, 2) = std::nan("");
  endless(0, 0) = std::numeric_limits<double>::infinity();
  singular(0, 1) = singular(1, 0) = 1.0;
  negative(3, 3) = -1.0;
  skewed(0, 1) = 0.5;
  tiny(5, 5) = 1e-13;
  for (const Matrix6d& M : {nan, endless, singular, negative, skewed, tiny, Matrix6d(0.0 * I)}) {
    EXPECT_FALSE(is_information(M)) << M;
  }
}

}  // namespace
}  // namespace prospect::relative_pose_test
