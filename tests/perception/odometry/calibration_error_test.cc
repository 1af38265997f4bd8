// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/calibration_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "perception/odometry/se3.h"

namespace prospect::calibration_error_test {
namespace {

StereoCamera camera() {
  StereoCamera c;
  c.left = {330.0, 335.0, 240.0, 180.0, 480.0, 360.0};
  c.baseline = 0.12;
  return c;
}

TEST(CalibrationError, DerivativesAreThoseOfTheResidual) {
  Eigen::Matrix<double, 6, 1> xi;
  xi << 0.1, -0.05, -0.4, 0.02, 0.1, -0.03;
  const Eigen::Isometry3d T_CW = exp_se3(xi);
  for (const bool sees_right : {true, false}) {
    PointObservation o;
    o.measured << 300.0, 120.0, 14.0;
    o.left << 330.0, 110.0;
    if (sees_right) o.right = 312.0;
    ObservationResidual residual;
    ASSERT_TRUE(observation_residual(camera(), T_CW, o, o.measured, residual));
    const auto J = by_calibration(camera(), o, residual, o.measured);
    for (int error = 0; error < kCalibrationErrors; ++error) {
      const auto moved = [&](double h) {
        StereoCamera c = camera();
        PointObservation p = o;
        if (error == 0) c.left.cx += h;
        if (error == 1) c.left.cy += h;
        if (error == 2) {
          c.left.fx *= 1.0 + h;
          c.left.fy *= 1.0 + h;
        }
        if (error == 3) c.baseline *= 1.0 + h;
        if (error == kDisparityError) {
          p.measured.z() += h;
          p.right -= h;
        }
        ObservationResidual r;
        EXPECT_TRUE(observation_residual(c, T_CW, p, p.measured, r));
        return r.r;
      };
      const double h = 1e-5;
      const Eigen::Vector3d expected = (moved(h) - moved(-h)) / (2.0 * h);
      EXPECT_LT((J.col(error) - expected).norm(), 1e-6 * (1.0 + expected.norm()))
          << error << ": " << J.col(error).transpose() << " for " << expected.transpose();
    }
  }
}

TEST(CalibrationError, CovarianceIsOfTheOptions) {
  const CalibrationMatrix C = calibration_covariance({0.5, 0.002, 0.003}, 0.3);
  EXPECT_DOUBLE_EQ(C(1, 1), 0.25);
  EXPECT_DOUBLE_EQ(C(2, 2), 0.002 * 0.002);
  EXPECT_DOUBLE_EQ(C(3, 3), 0.003 * 0.003);
  EXPECT_DOUBLE_EQ(C(kDisparityError, kDisparityError), 0.3 * 0.3);
  EXPECT_DOUBLE_EQ(C.sum(), C.trace());
}

}  // namespace
}  // namespace prospect::calibration_error_test
