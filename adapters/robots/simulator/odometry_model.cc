// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/odometry_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/support/cholesky.h"
#include "engine/support/eigenvalues.h"
#include "models/knobs.h"
#include "models/mixed_bits.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr double kPositionBound = 0.05;  // [m] of one keyframe
constexpr double kHeadingBound = 0.05;   // [rad]

Eigen::Matrix2d rotation(double yaw) { return Eigen::Rotation2Dd(yaw).toRotationMatrix(); }

/// Of the pose after a motion by `moved` (in W) in that before it: a turn of the yaw turns the
/// motion by a quarter.
Eigen::Matrix4d motion_jacobian(const Eigen::Vector3d& moved) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 3) = -moved.y();
  F(1, 3) = moved.x();
  return F;
}

// Radical inverse: the low-discrepancy sequence of van der Corput in a base.
double radical_inverse(int n, int base) {
  double value = 0.0, digit = 1.0 / base;
  for (; n > 0; n /= base, digit /= base) value += digit * (n % base);
  return value;
}

}  // namespace

OdometryModel::OdometryModel(const OdometryOptions& options, const StereoCamera& stereo,
                             const CameraMount& mount, const Pose& start, std::uint64_t seed)
    : options_(options), stereo_(stereo), mount_(mount), noise_(seed) {
  check_knobs("odometry", options);
  true_keyframe_ = start;
  keyframe_ = start;
  const Eigen::Matrix3d reference = information(reference_points(stereo)).inverse();
  position_scale_ = options.position_sigma / std::sqrt(reference(0, 0) + reference(1, 1));
  heading_scale_ = options.heading_sigma / std::sqrt(reference(2, 2));
  check_parameter(std::isfinite(position_scale_) && std::isfinite(heading_scale_), "odometry",
                  "information", reference(0, 0),
                  "regular at the reference points: check camera and mount");
  std::mt19937_64 calibration(mixed_bits(seed));
  std::normal_distribution<double> normal;
  for (const int error : {0, 1, 2}) {
    calibration_[error] = calibration_sigma()[error] * normal(calibration);
  }
  lost_covariance_ = keyframe_covariance(reference_points(stereo, std::max(1, options.lost_below)));
}

Eigen::Vector3d OdometryModel::calibration_sigma() const {
  return {options_.scale_error, options_.direction_error, options_.turn_error};
}

std::vector<Eigen::Vector3d> OdometryModel::reference_points(const StereoCamera& stereo,
                                                             int count) {
  const PinholeCamera& c = stereo.left;
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int n = 1; n <= count; ++n) {
    const double u = c.width * radical_inverse(n, 2);
    const double v = c.height * radical_inverse(n, 3);
    const double z = 1.0 + 4.0 * radical_inverse(n, 5);
    points.emplace_back((u - c.cx) / c.fx * z, (v - c.cy) / c.fy * z, z);
  }
  return points;
}

Eigen::Matrix3d OdometryModel::information(const std::vector<Eigen::Vector3d>& points_C) const {
  const PinholeCamera& c = stereo_.left;
  const Eigen::Matrix3d R_CB = mount_.T_BC.linear().transpose();
  const Eigen::Vector3d weight(0.5 / (stereo_.sigma_u * stereo_.sigma_u),
                               0.5 / (stereo_.sigma_v * stereo_.sigma_v),
                               0.5 / (stereo_.sigma_d * stereo_.sigma_d));
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& Y : points_C) {
    if (!Y.allFinite() || Y.z() < 1e-3) continue;
    // Moving the body by (x, y, yaw) moves a fixed point by -(e_x, e_y, e_z x Y_B) in B.
    const Eigen::Vector3d Y_B = mount_.T_BC * Y;
    Eigen::Matrix3d motion;
    motion.col(0) = -R_CB.col(0);
    motion.col(1) = -R_CB.col(1);
    motion.col(2) = -R_CB * Eigen::Vector3d::UnitZ().cross(Y_B);
    const double iz = 1.0 / Y.z();
    Eigen::Matrix3d uvd = Eigen::Matrix3d::Zero();
    uvd(0, 0) = c.fx * iz;
    uvd(0, 2) = -c.fx * Y.x() * iz * iz;
    uvd(1, 1) = c.fy * iz;
    uvd(1, 2) = -c.fy * Y.y() * iz * iz;
    uvd(2, 2) = -c.fx * stereo_.baseline * iz * iz;
    const Eigen::Matrix3d H = uvd * motion;
    sum += H.transpose() * weight.asDiagonal() * H;
  }
  return sum;
}

Eigen::Matrix3d OdometryModel::keyframe_covariance(
    const std::vector<Eigen::Vector3d>& points_C) const {
  // In units of the bounds, so that bounding is a floor on the eigenvalues of the information.
  const Eigen::Vector3d bound(kPositionBound, kPositionBound, kHeadingBound);
  const Eigen::Vector3d scale(position_scale_, position_scale_, heading_scale_);
  if (position_scale_ == 0.0 || heading_scale_ == 0.0) {
    // No noise asked for in one or both: the bound does not matter.
    const Eigen::Matrix3d I = information(points_C) + 1e-9 * Eigen::Matrix3d::Identity();
    return scale.asDiagonal() * I.inverse() * scale.asDiagonal();
  }
  const Eigen::Vector3d unit = bound.cwiseQuotient(scale);
  const Eigen::Matrix3d J = unit.asDiagonal() * information(points_C) * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(J);
  const Eigen::Vector3d variance = eigen.eigenvalues().cwiseMax(1.0).cwiseInverse();
  const Eigen::Matrix3d Q =
      eigen.eigenvectors() * variance.asDiagonal() * eigen.eigenvectors().transpose();
  return bound.asDiagonal() * Q * bound.asDiagonal();
}

bool OdometryModel::image(const Pose& true_pose, const std::vector<Eigen::Vector3d>& points_C) {
  if (options_.perfect) {
    true_keyframe_ = keyframe_ = true_pose;
    return true;
  }
  const int count = static_cast<int>(points_C.size());
  const Localization before = localization_;
  localization_ = count < options_.lost_below       ? Localization::kLost
                  : count < options_.degraded_below ? Localization::kDegraded
                                                    : Localization::kOk;
  const bool lost = localization_ == Localization::kLost;
  if (lost && before != Localization::kLost) {
    ++losses_;
    turned_since_loss_ = 0.0;
    if (!adrift_) {
      covariance_at_loss_ = covariance_;
      by_calibration_at_loss_ = by_calibration_;
      place_at_loss_ = keyframe_.position;
      drift_covariance_ = Eigen::Vector4d(1e-4, 1e-4, 0.0, 2.5e-5).asDiagonal();
    }
    adrift_ = true;
  }

  const Eigen::Vector3d moved = true_pose.position - true_keyframe_.position;
  const double distance = moved.head<2>().norm();
  const double turned = true_pose.yaw - true_keyframe_.yaw;
  const bool due = distance >= options_.keyframe_distance - 1e-9 ||
                   std::abs(turned) >= options_.keyframe_angle - 1e-9;
  // A loss or a recovery ends the motion that was measured in the old way.
  const bool changed = lost != (before == Localization::kLost) && (distance > 0.0 || turned != 0.0);
  if (!due && !changed) return false;

  const double position = options_.reckoning_distance * distance;
  const double heading =
      options_.reckoning_angle * std::abs(turned) + options_.reckoning_heading * distance;
  Eigen::Matrix3d Q =
      lost_covariance_ +
      Eigen::Matrix3d(Eigen::Vector3d(position * position, position * position, heading * heading)
                          .asDiagonal());
  const bool seen = !lost && before != Localization::kLost;
  Eigen::Matrix3d B = Eigen::Matrix3d::Zero();  // de / dc
  if (seen) {
    const Eigen::Vector2d d = rotation(-true_pose.yaw) * moved.head<2>();
    B.topLeftCorner<2, 2>() << d.x(), -d.y(), d.y(), d.x();
    B(2, 2) = turned;
    // (Q^-1 + P^-1)^-1, also where one of them is zero.
    const Eigen::Matrix3d P = keyframe_covariance(points_C);
    const Eigen::Matrix3d sum = Q + P;
    Q = sum.isZero(0.0) ? sum : Eigen::Matrix3d(Q - Q * sum.ldlt().solve(Q));
    if (losses_ > 0) {
      turned_since_loss_ += std::abs(turned);
      const double share =
          std::abs(turned) * std::exp(-2.0 * turned_since_loss_ / options_.after_loss_turning);
      const double p = options_.after_loss_position, yaw = options_.after_loss_heading;
      Q.diagonal() += share * Eigen::Vector3d(0.5 * p * p, 0.5 * p * p, yaw * yaw);
    }
  }
  std::normal_distribution<double> normal(0.0, 1.0);
  Eigen::Vector3d draw;
  for (int a = 0; a < 3; ++a) draw[a] = normal(noise_);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(Q);
  const Eigen::Vector3d error =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseProduct(draw) +
      B * calibration_;

  const Pose old = keyframe_;
  keyframe_ = estimate(true_pose);
  keyframe_.position.head<2>() += rotation(keyframe_.yaw) * error.head<2>();

  // p' = p + R(yaw) dp + R(yaw + dyaw) e
  const Eigen::Matrix4d F = motion_jacobian(keyframe_.position - old.position);
  Eigen::Matrix<double, 4, 3> G = Eigen::Matrix<double, 4, 3>::Zero();
  G.topLeftCorner<2, 2>() = rotation(keyframe_.yaw);
  G(3, 2) = 1.0;
  covariance_ = F * covariance_ * F.transpose() + G * Q * G.transpose();
  by_calibration_ = F * by_calibration_ + G * B;
  drift_covariance_ = F * drift_covariance_ * F.transpose() + G * Q * G.transpose();

  keyframe_.yaw += error[2];
  true_keyframe_ = true_pose;
  ++keyframes_;
  return true;
}

void OdometryModel::relocalize(const Pose& true_pose, const Pose& found,
                               const Eigen::Matrix3d& covariance) {
  true_keyframe_ = true_pose;
  keyframe_ = found;
  // Without a loss there is nothing to forget.
  if (adrift_) {
    const Eigen::Matrix4d F = motion_jacobian(found.position - place_at_loss_);
    covariance_ = F * covariance_at_loss_ * F.transpose();
    by_calibration_ = F * by_calibration_at_loss_;
    const Eigen::Vector3i planar(0, 1, 3);
    covariance_(planar, planar) += covariance;
  }
  adrift_ = false;
}

Eigen::Matrix4d OdometryModel::covariance(const Pose& true_pose) const {
  const Eigen::Matrix4d F = motion_jacobian(estimate(true_pose).position - keyframe_.position);
  const Eigen::Matrix<double, 4, 3> K = by_calibration_ * calibration_sigma().asDiagonal();
  return F * (covariance_ + K * K.transpose()) * F.transpose();
}

void OdometryModel::carry(const Pose& from, const Pose& true_pose) {
  keyframe_ = estimate(from);
  true_keyframe_ = true_pose;
  adrift_ = false;
}

Pose OdometryModel::estimate(const Pose& true_pose) const {
  if (options_.perfect) return true_pose;
  Pose pose;
  const double turn = keyframe_.yaw - true_keyframe_.yaw;
  const Eigen::Vector3d moved = true_pose.position - true_keyframe_.position;
  pose.position = keyframe_.position;
  pose.position.head<2>() += rotation(turn) * moved.head<2>();
  pose.position.z() += moved.z();
  pose.yaw = true_pose.yaw + turn;
  return pose;
}

}  // namespace prospect
