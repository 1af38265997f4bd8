// SPDX-License-Identifier: Apache-2.0
#include "models/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

namespace prospect::camera_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

const PinholeCamera kUneven{
    .fx = 430.0, .fy = 520.0, .cx = 300.0, .cy = 250.0, .width = 640.0, .height = 480.0};

class Camera : public testing::Test {
 protected:
  std::mt19937_64 rng_{11};
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  Vector3d point() { return {uniform(-5.0, 5.0), uniform(-5.0, 5.0), uniform(0.2, 20.0)}; }
};

TEST_F(Camera, ProjectsRightAndDown) {
  EXPECT_EQ(kUneven.project({0.0, 0.0, 2.0}), Vector2d(300.0, 250.0));
  EXPECT_EQ(kUneven.project({1.0, 0.0, 2.0}),
            Vector2d(515.0, 250.0));  // right of the axis: larger u
  EXPECT_EQ(kUneven.project({0.0, 1.0, 2.0}), Vector2d(300.0, 510.0));  // below the axis: larger v
}

TEST_F(Camera, ProjectionJacobianAgreesWithDifferences) {
  for (int n = 0; n < 1000; ++n) {
    const Vector3d Y = point();
    const auto J = kUneven.projection_jacobian(Y);
    for (int i = 0; i < 3; ++i) {
      const double h = 1e-4 * Y.z();
      const Vector3d e = h * Vector3d::Unit(i);
      const Vector2d difference = (8.0 * (kUneven.project(Y + e) - kUneven.project(Y - e)) -
                                   (kUneven.project(Y + 2.0 * e) - kUneven.project(Y - 2.0 * e))) /
                                  (12.0 * h);
      ASSERT_LE((J.col(i) - difference).norm(), 1e-8 * (1.0 + J.norm()));
    }
  }
}

TEST_F(Camera, FieldOfViewIsTheAngleBetweenTheImageBorders) {
  const PinholeCamera camera;
  EXPECT_NEAR(camera.horizontal_fov(), 2.0 * std::atan(320.0 / 450.0), 1e-15);
  EXPECT_NEAR(camera.vertical_fov(), 2.0 * std::atan(240.0 / 450.0), 1e-15);
  // Off-centre: the rays through the borders still span it.
  const Vector3d left((0.0 - kUneven.cx) / kUneven.fx, 0.0, 1.0);
  const Vector3d right((kUneven.width - kUneven.cx) / kUneven.fx, 0.0, 1.0);
  EXPECT_NEAR(kUneven.horizontal_fov(), std::acos(left.normalized().dot(right.normalized())),
              1e-14);
  EXPECT_TRUE(kUneven.in_image({0.0, 480.0}));
  EXPECT_FALSE(kUneven.in_image({-0.01, 10.0}));
  EXPECT_FALSE(kUneven.in_image({10.0, 480.01}));
}

TEST_F(Camera, TriangulationInvertsProjection) {
  const StereoCamera stereo{.left = kUneven};
  for (int n = 0; n < 1000; ++n) {
    const Vector3d Y = point();
    const Vector3d m = stereo.project(Y);
    ASSERT_LE((stereo.triangulate(m[0], m[1], m[2]) - Y).norm(), 1e-13 * Y.norm());
    const Vector2d right = stereo.left.project(Y - Vector3d(stereo.baseline, 0.0, 0.0));
    ASSERT_NEAR(m[2], m[0] - right.x(), 1e-10);  // disparity is what the right camera sees less
    ASSERT_NEAR(m[1], right.y(), 1e-12);         // rectified
    ASSERT_GT(m[2], 0.0);
  }
}

TEST_F(Camera, TriangulationJacobianAgreesWithDifferencesAndInvertsTheProjectionJacobian) {
  const StereoCamera stereo{.left = kUneven};
  for (int n = 0; n < 1000; ++n) {
    const Vector3d Y = point();
    const Vector3d m = stereo.project(Y);
    const Matrix3d J = stereo.triangulation_jacobian(m[0], m[1], m[2]);
    for (int i = 0; i < 3; ++i) {
      const double h = 1e-3 * m[2];
      const auto at = [&](double by) {
        const Vector3d p = m + by * Vector3d::Unit(i);
        return stereo.triangulate(p[0], p[1], p[2]);
      };
      const Vector3d difference =
          (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
      ASSERT_LE((J.col(i) - difference).norm(), 1e-9 * (1.0 + J.norm()));
    }
    const Eigen::Matrix<double, 2, 3> both = stereo.left.projection_jacobian(Y) * J;
    ASSERT_NEAR(both(0, 0), 1.0, 1e-12);
    ASSERT_NEAR(both(1, 1), 1.0, 1e-12);
    ASSERT_LE(std::abs(both(0, 1)) + std::abs(both(1, 0)) + both.col(2).norm(), 1e-10);
  }
}

TEST_F(Camera, DepthErrorGrowsWithTheSquareOfDepth) {
  const StereoCamera stereo;
  for (double z : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const Vector3d m = stereo.project({0.3, -0.2, z});
    const Matrix3d S = stereo.triangulation_covariance(m[0], m[1], m[2]);
    EXPECT_NEAR(std::sqrt(S(2, 2)), z * z * stereo.sigma_d / (stereo.left.fx * stereo.baseline),
                1e-12);
  }
}

TEST_F(Camera, TriangulationCovarianceAgreesWithMonteCarlo) {
  // Noise small against the disparity (d = 27 px at 2 m), so that the linearisation is good to
  // below the statistical error of 200000 samples (about 0.3 % of a variance, one standard
  // deviation).
  const StereoCamera stereo{.left = kUneven};
  std::normal_distribution<double> normal;
  for (const Vector3d& Y :
       {Vector3d(0.5, -0.4, 2.0), Vector3d(-0.8, 0.3, 1.5), Vector3d(0.0, 0.0, 1.0)}) {
    const Vector3d m = stereo.project(Y);
    const int n = 200000;
    Vector3d mean = Vector3d::Zero();
    Matrix3d square = Matrix3d::Zero();
    for (int i = 0; i < n; ++i) {
      const double u = m[0] + stereo.sigma_u * normal(rng_);
      const double v = m[1] + stereo.sigma_v * normal(rng_);
      const double d = m[2] + stereo.sigma_d * normal(rng_);
      const Vector3d e = stereo.triangulate(u, v, d) - Y;
      mean += e / n;
      square += e * e.transpose() / n;
    }
    const Matrix3d sampled = square - mean * mean.transpose();
    const Matrix3d predicted = stereo.triangulation_covariance(m[0], m[1], m[2]);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sampled(r, c), predicted(r, c),
                    0.02 * std::sqrt(predicted(r, r) * predicted(c, c)));
      }
    }
  }
}

TEST_F(Camera, TriangulationCovarianceIsSymmetricPositiveDefinite) {
  const StereoCamera stereo{.left = kUneven};
  for (int n = 0; n < 1000; ++n) {
    const Vector3d m = stereo.project(point());
    const Matrix3d S = stereo.triangulation_covariance(m[0], m[1], m[2]);
    ASSERT_TRUE(S.allFinite());
    ASSERT_LE((S - S.transpose()).norm(), 1e-14 * S.norm());
    ASSERT_GT(Eigen::SelfAdjointEigenSolver<Matrix3d>(S).eigenvalues().minCoeff(), 0.0);
  }
}

TEST_F(Camera, MountLooksWhereItIsTold) {
  const CameraMount forward;
  // A point ahead of the robot lies on the optical axis; left is left (-x), up is up (-y).
  const Eigen::Isometry3d T_CB = forward.T_BC.inverse();
  EXPECT_LE((T_CB * Vector3d(2.0, 0.0, 0.45) - Vector3d(0, 0, 2)).norm(), 1e-15);
  EXPECT_LE((T_CB * Vector3d(2.0, 0.5, 0.45) - Vector3d(-0.5, 0, 2)).norm(), 1e-15);
  EXPECT_LE((T_CB * Vector3d(2.0, 0.0, 0.95) - Vector3d(0, -0.5, 2)).norm(), 1e-15);
  for (int n = 0; n < 200; ++n) {
    const double yaw = uniform(-4.0, 4.0), pitch = uniform(-1.5, 1.5);
    const CameraMount mount{CameraMount::forward_facing({0.1, 0.2, 0.3}, yaw, pitch)};
    EXPECT_NO_THROW(validate(mount));
    EXPECT_LE(
        (mount.T_BC.linear().col(2) - Vector3d(std::cos(yaw) * std::cos(pitch),
                                               std::sin(yaw) * std::cos(pitch), -std::sin(pitch)))
            .norm(),
        1e-15);
    EXPECT_NEAR(mount.T_BC.linear()(2, 0), 0.0, 1e-15);  // image rows stay level
    EXPECT_LT(mount.T_BC.linear()(2, 1), 0.0);           // and v points down
    EXPECT_EQ(mount.T_BC.translation(), Vector3d(0.1, 0.2, 0.3));
  }
}

TEST_F(Camera, MountIsItsAngles) {
  const CameraMount turned{CameraMount::forward_facing({0.0, 0.0, 0.0}, 0.0, 0.0, 0.5 * M_PI)};
  // Clockwise by a right angle: what was right (-y of B) is down, so v points right.
  EXPECT_LE((turned.T_BC.linear().col(0) - Vector3d(0, 0, -1)).norm(), 1e-15);
  EXPECT_LE((turned.T_BC.linear().col(1) - Vector3d(0, 1, 0)).norm(), 1e-15);
  for (int n = 0; n < 200; ++n) {
    // Also straight up and down, where yaw and roll are one.
    const double pitch = n % 10 == 0   ? 0.5 * M_PI
                         : n % 10 == 1 ? -0.5 * M_PI
                                       : uniform(-1.57, 1.57);
    const CameraMount mount{CameraMount::forward_facing({0.1, 0.2, 0.3}, uniform(-4.0, 4.0), pitch,
                                                        uniform(-4.0, 4.0))};
    const MountAngles told = angles(mount);
    EXPECT_LE(std::abs(told.yaw), M_PI);
    EXPECT_LE(std::abs(told.pitch), 0.5 * M_PI);
    EXPECT_LE(std::abs(told.roll), M_PI);
    EXPECT_LE(
        (CameraMount::forward_facing({0.1, 0.2, 0.3}, told.yaw, told.pitch, told.roll).matrix() -
         mount.T_BC.matrix())
            .norm(),
        1e-14);
  }
}

template <class T>
std::string error_of(const T& value) {
  try {
    validate(value);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(Camera, ValidationNamesWhatIsWrong) {
  using testing::HasSubstr;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of(PinholeCamera{}), "no error");
  EXPECT_EQ(error_of(StereoCamera{}), "no error");
  EXPECT_EQ(error_of(RgbdFootprint{}), "no error");
  EXPECT_EQ(error_of(CameraMount{}), "no error");
  EXPECT_THAT(error_of(PinholeCamera{.fx = 0.0}), HasSubstr("fx is 0"));
  EXPECT_THAT(error_of(PinholeCamera{.fy = nan}), HasSubstr("fy is nan"));
  EXPECT_THAT(error_of(PinholeCamera{.cx = 641.0}),
              HasSubstr("cx: cx > width; expected at most width"));
  EXPECT_THAT(error_of(PinholeCamera{.height = -1.0}), HasSubstr("height is -1"));
  EXPECT_THAT(error_of(StereoCamera{.baseline = -0.12}), HasSubstr("baseline is -0.12"));
  EXPECT_THAT(error_of(StereoCamera{.sigma_d = nan}), HasSubstr("sigma_d is nan"));
  EXPECT_THAT(error_of(RgbdFootprint{.horizontal_fov = 7.0}), HasSubstr("horizontal_fov is 401"));
  EXPECT_THAT(error_of(RgbdFootprint{.horizontal_fov = 0.0}), HasSubstr("horizontal_fov is 0"));
  EXPECT_THAT(error_of(RgbdFootprint{.vertical_fov = -0.1}), HasSubstr("vertical_fov is -5.7"));
  EXPECT_THAT(error_of(RgbdFootprint{.vertical_fov = nan}), HasSubstr("vertical_fov is nan"));
  for (const double all_round : {2.0 * M_PI, 6.2832, 4.0}) {
    EXPECT_EQ(error_of(RgbdFootprint{.horizontal_fov = all_round, .vertical_fov = 0.0}),
              "no error");
  }
  EXPECT_THAT(error_of(RgbdFootprint{.min_range = 5.0}),
              HasSubstr("max_range: max_range <= min_range; expected more"));
  CameraMount mount;
  mount.T_BC.linear() *= 1.1;
  EXPECT_THAT(error_of(mount), HasSubstr("orthonormal"));
  mount = {};
  mount.T_BC.linear().col(0) *= -1.0;
  EXPECT_THAT(error_of(mount), HasSubstr("right-handed"));
  mount = {};
  mount.T_BC.translation().x() = nan;
  EXPECT_THAT(error_of(mount), HasSubstr("position is nan"));
  mount = {};
  mount.T_BC.linear()(0, 0) = nan;
  EXPECT_THAT(error_of(mount), HasSubstr("orthonormal"));
}

}  // namespace
}  // namespace prospect::camera_test
