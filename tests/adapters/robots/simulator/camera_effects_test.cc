// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/camera_effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "adapters/robots/simulator/simulator_options.h"

namespace prospect::camera_effects_test {
namespace {

double angle(const Eigen::Matrix3d& R) { return Eigen::AngleAxisd(R).angle(); }

TEST(CameraEffects, ACalibrationIsDrawnFromTheSeedWithinItsSpread) {
  const StereoCamera believed;
  const CameraEffects effects;
  struct Error {
    double spread;  // one standard deviation
    std::function<double(const TrueStereo&)> of;
  };
  const std::vector<Error> errors = {
      {effects.focal_length * believed.left.fx,
       [&](const TrueStereo& s) { return s.camera.fx - believed.left.fx; }},
      {effects.principal_point,
       [&](const TrueStereo& s) { return s.camera.cx - believed.left.cx; }},
      {effects.principal_point,
       [&](const TrueStereo& s) { return s.camera.cy - believed.left.cy; }},
      {effects.baseline * believed.baseline,
       [&](const TrueStereo& s) { return s.T_LR.translation().x() - believed.baseline; }},
      {effects.rotation, [](const TrueStereo& s) { return s.T_LR.linear()(0, 2); }},
      {effects.rotation, [](const TrueStereo& s) { return s.T_LR.linear()(2, 1); }},
      {effects.rotation, [](const TrueStereo& s) { return s.T_LR.linear()(1, 0); }}};
  constexpr int kSeeds = 400;
  for (const Error& error : errors) {
    double sum = 0.0, squares = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const double e =
          error.of(true_stereo(believed, effects, static_cast<std::uint64_t>(seed))) / error.spread;
      ASSERT_LT(std::abs(e), 3.6);
      sum += e;
      squares += e * e;
    }
    EXPECT_NEAR(sum / kSeeds, 0.0, 0.2);
    EXPECT_NEAR(squares / kSeeds, 1.0, 0.25);
  }
  const TrueStereo one = true_stereo(believed, effects, 1), two = true_stereo(believed, effects, 2);
  EXPECT_NE(one.camera.fx, two.camera.fx);
  EXPECT_EQ(one.camera.fx, true_stereo(believed, effects, 1).camera.fx);
  const double ratio = one.camera.fx / believed.left.fx;
  EXPECT_NEAR(one.camera.fy / believed.left.fy, ratio, 1e-12);

  const CameraMount mount;
  const CameraMount turned = true_mount(mount, effects, 1);
  const double turn = angle(mount.T_BC.linear().transpose() * turned.T_BC.linear());
  EXPECT_GT(turn, 0.0);
  EXPECT_LT(turn, 3.6 * std::sqrt(3.0) * effects.mount);
  EXPECT_EQ(mount.T_BC.translation(), turned.T_BC.translation());
}

TEST(CameraEffects, TheRobotIsToldHowFarItsCalibrationMayBeOff) {
  SimulatorOptions options;
  const CameraEffects& drawn = options.camera.effects;
  const PerceptionOptions usual;
  for (const double realism : {0.0, 1.0, 3.0}) {
    options.camera.realism = realism;
    const PerceptionOptions told = simulated_perception(options);
    const CalibrationErrorOptions& calibration = told.odometry.calibration;
    EXPECT_GE(calibration.principal_point, realism * drawn.principal_point);
    EXPECT_GE(calibration.focal_length, realism * drawn.focal_length);
    EXPECT_GE(calibration.baseline, realism * drawn.baseline);
    EXPECT_GE(told.odometry.disparity_offset.prior_angle, 1e3 * (drawn.rotation * realism));
    if (realism > 0.0) continue;
    EXPECT_EQ(calibration.focal_length, usual.odometry.calibration.focal_length);
    EXPECT_EQ(told.odometry.disparity_offset.prior_angle,
              usual.odometry.disparity_offset.prior_angle);
  }
}

TEST(CameraEffects, ScaledToNothingIsNothing) {
  const CameraEffects none = scaled({}, 0.0);
  const StereoCamera believed;
  const TrueStereo stereo = true_stereo(believed, none, 7);
  EXPECT_EQ(stereo.camera.fx, believed.left.fx);
  EXPECT_EQ(stereo.camera.cx, believed.left.cx);
  EXPECT_EQ(stereo.T_LR.translation(), Eigen::Vector3d(believed.baseline, 0.0, 0.0));
  EXPECT_EQ(stereo.T_LR.linear(), Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  const CameraMount mount;
  EXPECT_EQ(true_mount(mount, none, 7).T_BC.matrix(), mount.T_BC.matrix());
  EXPECT_EQ(none.exposure_lag, 0.0);
  EXPECT_EQ(scaled({}, 0.5).dirt, 0.5 * CameraEffects().dirt);
  EXPECT_EQ(scaled({}, 0.5).exposure_lag, CameraEffects().exposure_lag) << "a time, no size";
}

}  // namespace
}  // namespace prospect::camera_effects_test
