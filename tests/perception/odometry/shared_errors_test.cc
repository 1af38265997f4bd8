// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/shared_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "perception/odometry/point_observation.h"
#include "perception/odometry/track.h"

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
          observation_errors(o, residual, 0.1, 0.2, {0.6, 0.2, 0.1, 1.0, left_right});
      const Matrix3d whole = errors.landmark * errors.landmark.transpose() +
                             errors.area * errors.area.transpose() +
                             errors.image * errors.image.transpose() + errors.fresh;
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
      EXPECT_LT((errors.image * errors.image.transpose() - 0.1 * lasting).norm(), 1e-12);
      EXPECT_NEAR(errors.fresh(0, 0), 0.4 * 0.3 + 0.01, 1e-12);
    }
  }
}

TEST(SharedErrors, NumbersNameWhatIsShared) {
  Track a;
  a.id = 5;
  a.left << 10.0f, 20.0f;
  Track b = a;
  b.id = 6;
  b.left << 60.0f, 70.0f;
  b.pixel << 600.0f, 400.0f;  // it was elsewhere when it was made
  const ErrorNumbers of_a = error_numbers(a, 640.0, 480.0), of_b = error_numbers(b, 640.0, 480.0);
  EXPECT_EQ(of_a.landmark, 5u);
  EXPECT_EQ(of_b.landmark, 6u);
  EXPECT_EQ(of_a.area, of_b.area);
  EXPECT_EQ(of_a.image, of_b.image);
  EXPECT_NE(of_a.area, of_a.image);
  // Elsewhere in the image.
  b.left << 639.9f, 479.9f;
  const ErrorNumbers other = error_numbers(b, 640.0, 480.0);
  EXPECT_NE(of_a.area, other.area);
  EXPECT_EQ(of_a.image, other.image);
  // All of them, ascending, and no landmark's.
  const std::vector<std::uint64_t>& all = numbers_of_areas();
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  for (const std::uint64_t number : {of_a.area, other.area, of_a.image}) {
    EXPECT_TRUE(std::binary_search(all.begin(), all.end(), number));
  }
  EXPECT_FALSE(std::binary_search(all.begin(), all.end(), of_a.landmark));
}

}  // namespace
}  // namespace prospect::shared_errors_test
