// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/camera_time_offset.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "perception/odometry/median.h"

namespace prospect {
namespace {

constexpr std::size_t kLeastPoints = 12;
constexpr double kLeastNoise = 0.05;  // [px] of a row error, whatever the residuals say
constexpr double kHuber = 1.5;        // standard deviations

}  // namespace

CameraTimeOffset::CameraTimeOffset(const CameraTimeOffsetOptions& options) : options_(options) {
  if (!estimated()) return;
  const double rows = std::max(options.prior_rows, 1e-3);
  prior_.diagonal() << 1.0 / (options.prior_sigma * options.prior_sigma),
      Eigen::Vector3d::Constant(1.0 / (rows * rows));
}

void CameraTimeOffset::update(const StereoCamera& camera, const std::vector<Track>& tracks,
                              const Eigen::Isometry3d& T_CW,
                              const Eigen::Matrix<double, 6, 1>& velocity) {
  if (!estimated()) return;
  std::vector<Vector4d> rows;
  std::vector<double> errors, spread, flows, disparities;
  for (const Track& t : tracks) {
    if (!t.inlier || !t.in_right) continue;
    const Eigen::Vector3d Y = T_CW * t.position;
    if (!(Y.z() > 0.1)) continue;
    const Eigen::Vector3d Y_dot = velocity.head<3>() + velocity.tail<3>().cross(Y);
    const Eigen::Vector2d flow = camera.left.projection_jacobian(Y) * Y_dot;
    const Eigen::Vector2d p = t.left.cast<double>();
    rows.emplace_back(flow.y(), 1.0, (p.x() - camera.left.cx) / (0.5 * camera.left.width),
                      (p.y() - camera.left.cy) / (0.5 * camera.left.width));
    errors.push_back(t.row_error);
    spread.push_back(std::abs(t.row_error - rows.back().dot(state_)));
    flows.push_back(std::abs(flow.x()));
    disparities.push_back(camera.left.fx * camera.baseline / Y.z());
  }
  if (rows.size() < kLeastPoints) return;
  const double keep = std::exp(-1.0 / options_.memory);
  information_ *= keep;
  right_hand_side_ *= keep;
  flow_ = keep * flow_ + median(flows) / std::max(median(disparities), 1.0);
  frames_ = keep * frames_ + 1.0;
  const double noise = std::max(kLeastNoise, 1.4826 * median(spread));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error = std::abs(errors[i] - rows[i].dot(state_)) / noise;
    const double weight =
        options_.trust * std::min(1.0, kHuber / std::max(error, 1e-9)) / (noise * noise);
    information_ += weight * rows[i] * rows[i].transpose();
    right_hand_side_ += weight * errors[i] * rows[i];
  }
  state_ = Matrix4d(prior_ + information_).ldlt().solve(right_hand_side_);
}

double CameraTimeOffset::sigma() const {
  if (!estimated()) return 0.0;
  const Vector4d column = Matrix4d(prior_ + information_).ldlt().solve(Vector4d::Unit(0));
  return std::sqrt(column[0]);
}

double CameraTimeOffset::depth_error() const {
  return frames_ > 0.0 ? std::abs(value()) * flow_ / frames_ : 0.0;
}

double CameraTimeOffset::depth_sigma() const {
  return frames_ > 0.0 ? std::hypot(value(), sigma()) * flow_ / frames_ : 0.0;
}

bool CameraTimeOffset::out_of_step() const {
  return estimated() && depth_error() > options_.max_error && std::abs(value()) > 4.0 * sigma();
}

std::string CameraTimeOffset::reason(double period) const {
  const std::string late = value() > 0.0 ? "late" : "early";
  const double offset = std::abs(value());
  const double frames = period > 0.0 ? std::round(offset / period) : 0.0;
  // Neither a few milliseconds nor an estimate that leaves it open make a shift.
  const double tolerance = std::min(3.0 * sigma() + 0.05 * offset, 0.25 * period);
  if (frames >= 1.0 && std::abs(offset - frames * period) <= tolerance) {
    const std::string n = std::to_string(static_cast<int>(frames));
    return "the right images are " + n + (frames > 1.0 ? " frames " : " frame ") + late +
           ": pair each left image with the right one " + n +
           (value() > 0.0 ? " before" : " after") + " its own";
  }
  return "the right camera is " + std::to_string(std::lround(1e3 * offset)) + " ms " + late;
}

}  // namespace prospect
