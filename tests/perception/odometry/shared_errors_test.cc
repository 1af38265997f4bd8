// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/shared_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace prospect::shared_errors_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PointObservation observation() {
  PointObservation o;
  o.measured << 200.0, 150.0, 20.0;
  o.sigma << 0.1, 0.1, 0.3;
  o.left << 210.0, 160.0;
  o.right = 189.0;
  o.left_covariance << 0.3, 0.1, 0.1, 0.2;
  o.right_variance = 0.4;
  return o;
}

ObservationResidual linearised(const PointObservation& o) {
  ObservationResidual residual;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.05, 0.02, -0.2;
  EXPECT_TRUE(observation_residual(StereoCamera(), T, o, o.measured, residual));
  return residual;
}

TEST(SharedErrors, TheSharesMakeUpTheWhole) {
  PointObservation o = observation();
  for (const double left_right : {0.0, 0.9}) {
    for (const bool sees_right : {true, false}) {
      o.right = sees_right ? 189.0 : std::nan("");
      const ObservationResidual residual = linearised(o);
      const ObservationErrors errors =
          observation_errors(o, residual, 0.1, 0.2, {0.6, 0.2, 0.1, left_right});
      const Matrix3d whole = errors.landmark * errors.landmark.transpose() +
                             errors.area * errors.area.transpose() +
                             errors.keyframe * errors.keyframe.transpose() + errors.fresh;
      // What observation_weight() takes for the covariance, but for the correlation of both images.
      Matrix3d expected =
          residual.d_measured * o.sigma.cwiseAbs2().asDiagonal() * residual.d_measured.transpose();
      expected.topLeftCorner<2, 2>() += o.left_covariance;
      expected.diagonal() += Vector3d(0.01, 0.01, sees_right ? 0.44 : 0.0);
      if (sees_right) {
        const double slope = left_right * std::sqrt(0.4 / 0.3);
        expected(0, 2) += slope * 0.3;
        expected(1, 2) += slope * 0.1;
        expected(2, 0) = expected(0, 2);
        expected(2, 1) = expected(1, 2);
      }
      EXPECT_LT((whole - expected).norm(), 1e-12);
      // So much of each, and what is new in every frame.
      const Matrix3d lasting = whole - errors.fresh;
      EXPECT_LT((errors.area * errors.area.transpose() - 0.2 * lasting).norm(), 1e-12);
      EXPECT_LT((errors.keyframe * errors.keyframe.transpose() - 0.1 * lasting).norm(), 1e-12);
      EXPECT_NEAR(errors.fresh(0, 0), 0.4 * 0.3 + 0.01, 1e-12);
    }
  }
}

TEST(SharedErrors, NumbersNameWhatIsShared) {
  Track a;
  a.id = 5;
  auto first = std::make_shared<Anchor>(), second = std::make_shared<Anchor>();
  first->id = 1;
  second->id = 2;
  a.anchor = first;
  a.pixel << 10.0f, 20.0f;
  Track b = a;
  b.id = 6;
  b.pixel << 60.0f, 70.0f;
  const ErrorNumbers of_a = error_numbers(a, 640.0, 480.0), of_b = error_numbers(b, 640.0, 480.0);
  EXPECT_NE(of_a.landmark, of_b.landmark);
  EXPECT_EQ(of_a.area, of_b.area);
  EXPECT_EQ(of_a.keyframe, of_b.keyframe);
  // Elsewhere in the image.
  b.pixel << 639.9f, 479.9f;
  EXPECT_NE(of_a.area, error_numbers(b, 640.0, 480.0).area);
  EXPECT_EQ(of_a.keyframe, error_numbers(b, 640.0, 480.0).keyframe);
  // Of another keyframe; no number stands for two things.
  b.anchor = second;
  const ErrorNumbers other = error_numbers(b, 640.0, 480.0);
  for (const std::uint64_t mine : {of_a.landmark, of_a.area, of_a.keyframe}) {
    for (const std::uint64_t its : {other.landmark, other.area, other.keyframe}) {
      EXPECT_NE(mine, its);
    }
  }
  // The last of one keyframe's areas is not the next one's first.
  b.anchor = first;
  EXPECT_NE(error_numbers(b, 640.0, 480.0).area, other.keyframe);
}

}  // namespace
}  // namespace prospect::shared_errors_test
