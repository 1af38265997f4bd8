// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/inertial_witness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <stdexcept>

#include "models/knobs.h"

namespace prospect::inertial_witness_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Verdict = InertialWitness::Verdict;

constexpr double kRate = 100.0, kPeriod = 0.1, kG = 9.81;

/// A body in the plane that accelerates and turns as is told, its IMU and what vision makes of it.
class Drive {
 public:
  explicit Drive(const Vector3d& bias = {0.02, -0.01, 0.03}, const InertialOptions& options = {})
      : witness(options), bias_(bias) {}

  /// To the next frame: forward acceleration, yaw rate; what vision says of the pose.
  InertialWitness::Judgement frame(double acceleration, double yaw_rate,
                                   const std::function<Isometry3d(const Isometry3d&)>& seen = {},
                                   bool wheels = false) {
    const Isometry3d before = T_;
    const int steps = static_cast<int>(kPeriod * kRate);
    for (int k = 0; k < steps; ++k) {
      const double dt = 1.0 / kRate;
      ++count_;
      ImuSample s;
      s.stamp = count_ * dt;
      s.angular_velocity = Vector3d(0.0, 0.0, yaw_rate) + bias_ + fault_ + 0.005 * drawn();
      s.linear_acceleration = Vector3d(acceleration, speed_ * yaw_rate, kG) +
                              Vector3d(0.1, -0.08, 0.05) + 0.05 * drawn();
      s.R_BS = R_BS;
      s.angular_velocity = R_SB * s.angular_velocity;
      s.linear_acceleration = R_SB * s.linear_acceleration;
      if (imu) witness.add(s);
      T_.translation() += T_.linear() * Vector3d(speed_ * dt + 0.5 * acceleration * dt * dt, 0, 0);
      T_.rotate(Eigen::AngleAxisd(yaw_rate * dt, Vector3d::UnitZ()));
      speed_ += acceleration * dt;
    }
    SeenMotion now;
    now.stamp = count_ / kRate;
    now.T_WB = seen ? seen(T_) : T_;
    now.T_WB.translation() += 0.001 * drawn();
    now.T_WB.rotate(Eigen::AngleAxisd(0.0005 * drawn().x(), Vector3d::UnitZ()));
    now.covariance = 1e-6 * Eigen::Matrix3d::Identity();
    if (wheels) now.by_wheels = before.inverse() * T_;
    return witness.judge(now);
  }
  Vector3d drawn() {
    const double x = normal_(random_), y = normal_(random_), z = normal_(random_);
    return {x, y, z};
  }
  /// Standing, then a drive with turns to both sides.
  void prove() {
    for (int k = 0; k < 20; ++k) EXPECT_EQ(frame(0.0, 0.0).verdict != Verdict::kDisagrees, true);
    for (int k = 0; k < 40; ++k) {
      EXPECT_EQ(frame(k < 10 ? 0.5 : 0.0, 0.5 * std::sin(0.3 * k)).verdict, Verdict::kAgrees) << k;
    }
  }

  InertialWitness witness;
  bool imu = true;
  Vector3d fault_ = Vector3d::Zero();
  Eigen::Quaterniond R_BS = Eigen::Quaterniond::Identity(), R_SB = Eigen::Quaterniond::Identity();
  const Isometry3d& truth() const { return T_; }

 private:
  Isometry3d T_ = Isometry3d::Identity();
  Vector3d bias_;
  double speed_ = 0.0;
  int count_ = 0;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST(InertialWitness, LearnsBiasAndGravityAndForetellsTheMotion) {
  Drive drive;
  drive.prove();
  EXPECT_TRUE(drive.witness.gyro_bias().isApprox(Vector3d(0.02, -0.01, 0.03), 0.15))
      << drive.witness.gyro_bias().transpose();
  EXPECT_LT(drive.witness.gyro_bias_sigma(), 0.01);
  ASSERT_TRUE(drive.witness.up_in_W());
  EXPECT_GT(drive.witness.up_in_W()->z(), std::cos(3.0 * kRadiansPerDegree));
  EXPECT_TRUE(drive.witness.doubt(Isometry3d::Identity()).isZero());
  EXPECT_EQ(drive.witness.complaint(), "");
  EXPECT_EQ(drive.witness.contradicted(), 0);
}

TEST(InertialWitness, AViewThatRestsWhileTheBodyTurnsIsToldOf) {
  Drive drive;
  drive.prove();
  const Isometry3d held = drive.truth();
  for (int k = 0; k < 20; ++k) {
    const auto said = drive.frame(0.0, 0.4, [&](const Isometry3d&) { return held; });
    EXPECT_EQ(said.verdict, Verdict::kDisagrees) << k;
    EXPECT_NE(said.reason.find("gyro"), std::string::npos);
  }
  // 0.8 rad off: the covariance holds it within four deviations.
  const auto C = drive.witness.doubt(held.inverse());
  EXPECT_GT(std::sqrt(C(5, 5)), 0.8 / 4.0);
  EXPECT_LT(std::sqrt(C(5, 5)), 1.0);
  EXPECT_EQ(drive.witness.complaint(), "");  // it was right before
}

TEST(InertialWitness, ASlowTurnShowsWithinASecond) {
  Drive drive;
  drive.prove();
  for (int k = 0; k < 20; ++k) drive.frame(0.0, 0.0);
  const Isometry3d start = drive.truth();
  int told = 0;
  for (int k = 0; k < 12; ++k) {
    told += drive
                .frame(0.0, 0.06,
                       [&](const Isometry3d& T) {
                         Isometry3d seen = T;
                         seen.linear() = start.linear();
                         return seen;
                       })
                .verdict == Verdict::kDisagrees;
  }
  EXPECT_GE(told, 4);
}

TEST(InertialWitness, WhoSeemsToJumpWhileTheAccelerometerRestsIsToldOf) {
  Drive drive;
  for (int k = 0; k < 40; ++k) drive.frame(0.0, 0.0);
  // Something walks by at 1 m/s, and is taken for the world.
  int told = 0;
  for (int k = 0; k < 8; ++k) {
    const auto said = drive.frame(0.0, 0.0, [&](const Isometry3d& T) {
      return Isometry3d(Eigen::Translation3d(0.0, 0.1 * (k + 1), 0.0) * T);
    });
    told += said.verdict == Verdict::kDisagrees;
    if (k == 0) {
      EXPECT_NE(said.reason.find("accelerometer"), std::string::npos) << said.reason;
    }
  }
  EXPECT_EQ(told, 8);
  const auto C = drive.witness.doubt(drive.truth().inverse());
  EXPECT_GT(std::sqrt(C(1, 1)), 0.8 / 4.0);
}

TEST(InertialWitness, WrongAxesAreNotBelievedAndWheelsOutvote) {
  {
    Drive drive;
    drive.R_SB = Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitX());  // mounted otherwise than told
    int degraded = 0;
    for (int k = 0; k < 80; ++k) {
      degraded += drive.frame(0.0, 0.6 * std::sin(0.3 * k)).verdict == Verdict::kDisagrees;
    }
    EXPECT_NE(drive.witness.complaint(), "");
    EXPECT_LE(degraded, 8);
    EXPECT_FALSE(drive.witness.expected(8.05));
  }
  Drive drive;
  drive.prove();
  drive.fault_ = {0.0, 0.0, 0.4};
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(drive.frame(0.0, 0.2, {}, true).verdict, Verdict::kOutvoted) << k;
  }
  EXPECT_NE(drive.witness.complaint(), "");
  EXPECT_TRUE(drive.witness.doubt(Isometry3d::Identity()).isZero());
  // Well again, it is believed after it has agreed for a while.
  drive.fault_.setZero();
  for (int k = 0; k < 20; ++k) drive.frame(0.0, 0.5 * std::sin(0.4 * k), {}, true);
  EXPECT_EQ(drive.witness.complaint(), "");
}

TEST(InertialWitness, ABiasThatComesSuddenlyIsADisagreement) {
  Drive drive;
  drive.prove();
  drive.fault_ = {0.0, 0.0, 0.4};
  int told = 0;
  for (int k = 0; k < 20; ++k) told += drive.frame(0.0, 0.0).verdict == Verdict::kDisagrees;
  EXPECT_EQ(told, 20);  // nobody can tell who is wrong
}

TEST(InertialWitness, SilenceSaysNothing) {
  Drive drive;
  drive.prove();
  drive.imu = false;
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(
        drive.frame(0.0, 0.3, [](const Isometry3d&) { return Isometry3d::Identity(); }).verdict,
        Verdict::kUnknown);
  }
  EXPECT_THROW(InertialWitness({.gate = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::inertial_witness_test
