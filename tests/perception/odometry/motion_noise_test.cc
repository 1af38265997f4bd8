// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/motion_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "models/body_transform.h"
#include "models/camera.h"

namespace prospect::motion_noise_test {
namespace {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Claims of a camera that sits on the body's origin and looks ahead, which it drives.
class ClaimingOdometry final : public Odometry {
 public:
  using Variances = std::function<std::pair<double, double>(int frames)>;  // position, yaw
  /// `ahead`: what the variance along the camera's axis has besides [m^2].
  explicit ClaimingOdometry(Variances variances, std::function<double(int frames)> ahead = {})
      : variances_(std::move(variances)), ahead_(std::move(ahead)) {}
  OdometryFrame process(double, const ImageView&, const ImageView&,
                        const std::optional<Isometry3d>&) override {
    return {};
  }
  std::shared_ptr<const LandmarkMap> landmarks(double) const override { return nullptr; }
  const std::vector<LandmarkSighting>& sightings() const override { return none_; }
  const std::vector<std::uint64_t>& given_up() const override { return gone_; }
  std::optional<Matrix6d> covariance_since(int frames) const override {
    const auto [position, yaw] = variances_(frames);
    Matrix6d C = Matrix6d::Zero();
    C.diagonal() << position, position, position, yaw, yaw, yaw;
    if (ahead_) C(2, 2) += ahead_(frames);
    return C;
  }
  std::optional<MotionAhead> motion_ahead() const override { return to_come; }
  std::optional<MotionAhead> to_come;

 private:
  Variances variances_;
  std::function<double(int)> ahead_;
  std::vector<LandmarkSighting> none_;
  std::vector<std::uint64_t> gone_;
};

const Isometry3d kMount = CameraMount::forward_facing(Eigen::Vector3d::Zero());

/// Frames along an arc: `step` [m] and `turn` [rad] each, `aside` [rad] of where the camera looks.
void drive(MotionNoise& noise, const Odometry& odometry, int frames, double step, double turn,
           int tracked, Pose& pose, double aside = 0.0) {
  for (int k = 0; k < frames; ++k) {
    OdometryFrame frame;
    frame.state = Localization::kOk;
    frame.tracked = tracked;
    frame.T_WC = body_transform(pose) * kMount;
    noise.add(frame, odometry);
    const double way = pose.yaw + aside;
    pose.position += step * Eigen::Vector3d(std::cos(way), std::sin(way), 0.0);
    pose.yaw += turn;
  }
}

TEST(MotionNoise, FindsARandomWalkOfMetresAndRadians) {
  OdometryNoise truth;
  truth.position_per_metre = 0.006;
  truth.position_per_radian = 0.001;
  truth.yaw_per_metre = 0.0002;
  truth.yaw_per_radian = 0.004;
  double step = 0.05, turn = 0.0;
  constexpr int kTracked = 80;
  const ClaimingOdometry odometry([&](int frames) {
    const double s = step * frames, a = turn * frames, fewer = 202.0 / (kTracked + 2.0);
    const auto square = [](double x) { return x * x; };
    return std::pair(
        fewer * (square(truth.position_per_metre) * s + square(truth.position_per_radian) * a),
        fewer * (square(truth.yaw_per_metre) * s + square(truth.yaw_per_radian) * a));
  });
  MotionNoise noise(kMount);
  Pose pose;
  EXPECT_FALSE(noise.noise());
  // Straight ahead, on the spot, and both, in turn; a span holds one of them.
  for (int round = 0; round < 12; ++round) {
    step = round % 3 == 1 ? 0.0 : 0.05;
    turn = round % 3 == 0 ? 0.0 : 0.04;
    OdometryFrame lost;  // so that no span holds two kinds
    noise.add(lost, odometry);
    drive(noise, odometry, 31, step, turn, kTracked, pose);
  }
  ASSERT_TRUE(noise.noise());
  const OdometryNoise found = *noise.noise();
  // The prior pulls a little towards what is assumed.
  EXPECT_NEAR(found.position_per_metre, truth.position_per_metre, 0.1 * truth.position_per_metre);
  EXPECT_LT(found.position_per_radian, 0.003);
  EXPECT_LT(found.yaw_per_metre, 0.0011);
  EXPECT_NEAR(found.yaw_per_radian, truth.yaw_per_radian, 0.1 * truth.yaw_per_radian);
  // A tenth of the variance over a metre at most: what the prior pulls away is not seen across.
  EXPECT_LT(found.scale, 0.3 * truth.position_per_metre);
  EXPECT_EQ(found.reference_count, OdometryNoise().reference_count);
}

TEST(MotionNoise, TellsAnErrorOfTheScaleFromARandomWalk) {
  constexpr double kStep = 0.05, kScale = 0.008, kPerMetre = 0.003;
  const ClaimingOdometry odometry(
      [&](int frames) {
        return std::pair(kPerMetre * kPerMetre * kStep * frames, 0.25e-6 * kStep * frames);
      },
      [&](int frames) { return std::pow(kScale * kStep * frames, 2); });
  MotionNoise noise(kMount);
  Pose pose;
  pose.yaw = 0.7;
  drive(noise, odometry, 40, kStep, 0.0, 200, pose);
  ASSERT_TRUE(noise.noise());
  EXPECT_NEAR(noise.noise()->scale, kScale, 0.02 * kScale);
  EXPECT_NEAR(noise.noise()->position_per_metre, kPerMetre, 0.02 * kPerMetre);
  // The same variances, of one that drives sideways: what grows across the way is not the scale's.
  MotionNoise sideways(kMount);
  drive(sideways, odometry, 40, kStep, 0.0, 200, pose, M_PI_2);
  EXPECT_LT(sideways.noise()->scale, 0.2 * kScale);
}

TEST(MotionNoise, AScaleThatIsBeingLearnedDrownsNoWalk) {
  // The scale is known better and better, from 4 % on, and is a thousand times the walk; turns
  // differ from frame to frame. What is counted on across the way stays what is claimed.
  constexpr double kStep = 1.2, kPerMetre = 0.004;
  double scale = 0.04;
  const ClaimingOdometry odometry(
      [&](int frames) {
        const double walk = kPerMetre * kPerMetre * kStep * frames;
        return std::pair(walk, 0.0625 * walk);
      },
      [&](int frames) { return std::pow(scale * kStep * frames, 2); });
  MotionNoise noise(kMount);
  Pose pose;
  constexpr int kTracked = 120;
  for (int k = 0; k < 60; ++k) {
    scale = std::max(0.004, 0.93 * scale);
    drive(noise, odometry, 1, kStep, k % 3 == 0 ? 0.02 : 0.002, kTracked, pose);
    if (k < 8) continue;
    ASSERT_TRUE(noise.noise()) << k;
    const OdometryNoise found = *noise.noise(), assumed;
    const double fewer =
        (assumed.reference_count + assumed.floor_count) / (kTracked + assumed.floor_count);
    const double s = 5.0 * kStep, a = 0.04;
    const double counted_on = fewer * (std::pow(found.position_per_metre, 2) * s +
                                       std::pow(found.position_per_radian, 2) * a);
    EXPECT_NEAR(std::sqrt(counted_on / (kPerMetre * kPerMetre * s)), 1.0, 0.3) << k;
    EXPECT_GT(found.scale, scale) << k;
    EXPECT_LT(found.scale, 0.04) << k;
  }
}

TEST(MotionNoise, BeforeItMovesWhatIsToComeIsCountedOn) {
  // The scale as the odometry would claim it of a motion ahead; then all that it does claim.
  constexpr double kWay = 0.3, kPerMetre = 0.01, kScale = 0.03, kStep = 0.1;
  ClaimingOdometry odometry([&](int frames) {
    const double walk = 1e-6 * kStep * frames;
    return std::pair(walk, walk);
  });
  MotionAhead ahead;
  ahead.T_CC.translation().z() = kWay;
  ahead.tracked = 200;
  ahead.covariance.setIdentity();
  ahead.covariance *= kPerMetre * kPerMetre * kWay;
  ahead.covariance(2, 2) += std::pow(kScale * kWay, 2);
  odometry.to_come = ahead;
  MotionNoise noise(kMount);
  OdometryFrame first;
  first.state = Localization::kOk;
  first.tracked = 200;
  first.keyframe = true;
  first.T_WC = kMount;
  noise.add(first, odometry);
  ASSERT_TRUE(noise.noise());
  EXPECT_EQ(noise.noise()->position_per_metre, OdometryNoise().position_per_metre);
  EXPECT_EQ(noise.noise()->yaw_per_metre, OdometryNoise().yaw_per_metre);
  EXPECT_NEAR(noise.noise()->scale, kScale, 0.05 * kScale);
  Pose pose;
  drive(noise, odometry, 4, kStep, 0.0, 200, pose);
  EXPECT_NEAR(noise.noise()->scale, kScale, 0.05 * kScale);
  drive(noise, odometry, 30, kStep, 0.0, 200, pose);
  EXPECT_LT(noise.noise()->scale, 0.1 * kScale);
  EXPECT_NEAR(noise.noise()->position_per_metre, 1e-3, 1e-4);
}

TEST(MotionNoise, WhatWasNotDrivenStaysInTheRatioThatIsAssumed) {
  const ClaimingOdometry odometry(
      [](int frames) { return std::pair(16e-6 * 0.05 * frames, 0.25e-6 * 0.25 * 0.05 * frames); });
  MotionNoise noise(kMount);
  Pose pose;
  drive(noise, odometry, 30, 0.05, 0.0, 200, pose);
  ASSERT_TRUE(noise.noise());
  const OdometryNoise found = *noise.noise(), assumed;
  EXPECT_NEAR(found.position_per_metre, 2.0 * assumed.position_per_metre, 1e-9);
  EXPECT_NEAR(found.position_per_radian, 2.0 * assumed.position_per_radian, 1e-9);
  EXPECT_NEAR(found.yaw_per_metre, 0.5 * assumed.yaw_per_metre, 1e-9);
  EXPECT_NEAR(found.yaw_per_radian, 0.5 * assumed.yaw_per_radian, 1e-9);
  EXPECT_LT(found.scale, 1e-6);
}

TEST(MotionNoise, SaysNothingWithoutMotionOrClaims) {
  const ClaimingOdometry odometry([](int) { return std::pair(1e-6, 1e-6); });
  MotionNoise at_rest(kMount), lost(kMount);
  Pose pose;
  drive(at_rest, odometry, 60, 0.0, 0.0, 100, pose);
  EXPECT_FALSE(at_rest.noise());
  // Lost at every sixth frame: no span is long enough for five claims.
  for (int k = 0; k < 4; ++k) {
    drive(lost, odometry, 6, 0.05, 0.0, 100, pose);
    lost.add(OdometryFrame(), odometry);
  }
  EXPECT_FALSE(lost.noise());
}

}  // namespace
}  // namespace prospect::motion_noise_test
