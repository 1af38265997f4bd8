// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/visual_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "perception/fusion/wheel_fusion.h"
#include "perception/odometry/se3.h"
#include "perception/odometry/stereo_odometry.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/rendered_room.h"

namespace prospect::visual_motion_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

TEST(VisualMotion, IsThatOfTheBodyAndCarriesTheCovarianceOver) {
  // A camera 0.2 m ahead and 0.1 m to the left that looks along x of B, z forward, y down.
  Isometry3d T_BC = Isometry3d::Identity();
  T_BC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_BC.translation() << 0.2, 0.1, 0.4;
  // B turns by 0.5 rad and drives to (0.7, -0.3): where is the camera?
  Isometry3d M = Isometry3d::Identity();
  M.linear() = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()).toRotationMatrix();
  M.translation() << 0.7, -0.3, 0.0;
  const Isometry3d T_WC0 =
      exp_se3((Eigen::Matrix<double, 6, 1>() << 1, 2, 3, 0.3, -0.2, 0.9).finished());
  const Isometry3d T_WC = T_WC0 * T_BC.inverse() * M * T_BC;
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Identity();
  VisualMotion visual;
  set_motion(visual, T_WC0, T_WC, C, T_BC);
  EXPECT_LT((visual.motion - Vector3d(0.7, -0.3, 0.5)).norm(), 1e-12);
  // Against differences: T_CW <- exp(xi) T_CW.
  Eigen::Matrix<double, 3, 6> J;
  for (int i = 0; i < 6; ++i) {
    const double h = 1e-6;
    VisualMotion plus, minus;
    const Eigen::Matrix<double, 6, 1> e = h * Eigen::Matrix<double, 6, 1>::Unit(i);
    set_motion(plus, T_WC0, (exp_se3(e) * T_WC.inverse()).inverse(), C, T_BC);
    set_motion(minus, T_WC0, (exp_se3(-e) * T_WC.inverse()).inverse(), C, T_BC);
    J.col(i) = (plus.motion - minus.motion) / (2 * h);
  }
  EXPECT_LT((visual.covariance - J * J.transpose()).norm(), 1e-7);
}

/// Rendered images of a body that drives an arc, through visual odometry and the filter.
TEST(VisualMotion, OfRealFramesFixesABodyOnPoorWheels) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  StereoCamera camera;
  camera.left = {330.0, 330.0, 240.0, 180.0, 480.0, 360.0};
  camera.baseline = 0.12;
  const test::RenderedRoom room;
  Isometry3d T_BC = Isometry3d::Identity();
  T_BC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_BC.translation() << 0.15, 0.0, 1.05;
  constexpr double kSpeed = 0.5, kTurn = 0.17, kScale = 1.04;
  // Body and camera at time t.
  const auto body = [&](double t) {
    Isometry3d T = Isometry3d::Identity();
    const double yaw = -0.3 + kTurn * t, r = kSpeed / kTurn;
    T.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    T.translation() << -1.6 + r * (std::sin(yaw) - std::sin(-0.3)),
        -0.6 - r * (std::cos(yaw) - std::cos(-0.3)), 0.0;
    return T;
  };
  StereoOdometry odometry(camera, {}, body(0.0) * T_BC);
  VisualMotionReader reader(T_BC);
  WheelFusion fusion;
  double stamp = 0.0, worst = 0.0, normalised = 0.0;
  int frames = 0, keyframes = 0;
  for (int k = 0; k < 36; ++k) {
    const double t = 0.1 * k;
    for (; stamp <= t + 1e-9; stamp += 0.02) {
      fusion.add(WheelSample{stamp, {kSpeed / kScale, 0.0}, kTurn});
    }
    const bool dark = k >= 20 && k < 24;
    const auto pair = room.render(camera, body(t) * T_BC, 2.0, 500 + k);
    const Image black(480, 360, 0);
    const OdometryFrame frame = odometry.process(t, dark ? black.view() : pair.left.view(),
                                                 dark ? black.view() : pair.right.view());
    fusion.add(reader.read(frame));
    const FusedOdometry fused = fusion.at(t);
    const Isometry3d truth = body(0.0).inverse() * body(t);
    const double error = (fused.pose.position - truth.translation()).norm();
    worst = std::max(worst, error);
    keyframes += frame.keyframe;
    if (dark && k > 20) {
      EXPECT_EQ(fused.state, Localization::kDegraded) << k;
    } else if (!dark && k != 24) {
      EXPECT_EQ(fused.state, Localization::kOk) << k << " " << fused.reason;
    }
    if (k > 5) {
      const Eigen::Vector2d e = (fused.pose.position - truth.translation()).head<2>();
      normalised += e.dot(fused.covariance.topLeftCorner<2, 2>().ldlt().solve(e)) / 2.0;
      ++frames;
    }
  }
  const FusedOdometry fused = fusion.at(3.5);
  std::printf(
      "fused over 1.75 m, 4 frames dark: worst error %.1f mm, normalised error squared %.2f, scale "
      "%.4f +- %.4f of %.2f, %d keyframes\n",
      1e3 * worst, normalised / frames, fused.scale, fused.sigma_scale, kScale, keyframes);
  EXPECT_GT(keyframes, 2);
  EXPECT_LT(worst, 0.012);
  EXPECT_NEAR(fused.scale, kScale, 3.0 * fused.sigma_scale);
  EXPECT_LT(fused.sigma_scale, 0.025);
  // One run, errors that follow each other.
  EXPECT_LT(normalised / frames, 4.0);
}

}  // namespace
}  // namespace prospect::visual_motion_test
