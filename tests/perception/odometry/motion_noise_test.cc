#include "perception/odometry/motion_noise.h"

#include <gtest/gtest.h>

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

/// Claims of a camera that sits on the body's origin and looks ahead.
class ClaimingOdometry final : public Odometry {
 public:
  using Variances = std::function<std::pair<double, double>(int frames)>;  // position, yaw
  explicit ClaimingOdometry(Variances variances) : variances_(std::move(variances)) {}
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
    return C;
  }

 private:
  Variances variances_;
  std::vector<LandmarkSighting> none_;
  std::vector<std::uint64_t> gone_;
};

const Isometry3d kMount = CameraMount::forward_facing(Eigen::Vector3d::Zero());

/// Frames along an arc: `step` [m] and `turn` [rad] each.
void drive(MotionNoise& noise, const Odometry& odometry, int frames, double step, double turn,
           int tracked, Pose& pose) {
  for (int k = 0; k < frames; ++k) {
    OdometryFrame frame;
    frame.state = Localization::kOk;
    frame.tracked = tracked;
    frame.T_WC = body_transform(pose) * kMount;
    noise.add(frame, odometry);
    pose.position += step * Eigen::Vector3d(std::cos(pose.yaw), std::sin(pose.yaw), 0.0);
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
  EXPECT_EQ(found.reference_count, OdometryNoise().reference_count);
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
