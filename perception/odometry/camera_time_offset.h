// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/camera.h"
#include "perception/odometry/track.h"

namespace prospect {

class Knobs;

struct CameraTimeOffsetOptions {
  double prior_sigma = 0.2;  ///< [s] before anything was seen; 0: the offset is not estimated
  double prior_rows = 0.5;   ///< [px] of each of the three errors of the rows
  /// Evidence is worth this share of what it says: a landmark's errors are alike from frame to
  /// frame.
  double trust = 0.1;
  double memory = 300.0;    ///< [frames] after which evidence counts for 1/e
  double max_error = 0.01;  ///< share of the depth that the offset may cost; more: out of step
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CameraTimeOffsetOptions& options);

/// By how much later than the left image the right one was taken, tau [s].
///
/// While the camera moves, a late image shows every point farther along its way: at the pixel
/// (u_r, v_r) + tau (du/dt, dv/dt). Along the row this is a wrong disparity that follows the turn
/// rate, and at a constant rate it cannot be told from an error of the disparity's zero
/// (disparity_offset.h). Across the rows nothing hides it: a rectified pair shows no point in two
/// different rows. With the velocity xi = (v, omega) of the frame and a landmark's Y in C,
///   row error  v_r - v_l = tau dv/dt + c_0 + c_1 x + c_2 y + noise,
///   dv/dt = row 2 of dPi/dY (v + omega x Y),    x, y = (u - cx, v - cy) / (width / 2),
/// where c is what is wrong with the rectification: a shift, a roll, and focal lengths that differ.
/// Motion without pitch tells, too: a turn moves points towards the image's corners across rows, a
/// drive those above and below the middle.
///
/// Recursive least squares with Huber's loss; the noise of each frame is that of its own residuals.
/// Deterministic. Not thread-safe.
class CameraTimeOffset {
 public:
  explicit CameraTimeOffset(const CameraTimeOffsetOptions& options = {});

  /// A frame that was located at T_CW by these tracks, those that are inliers and whose patch was
  /// found in the right image; velocity as in trusted_pose.h, per second.
  void update(const StereoCamera& camera, const std::vector<Track>& tracks,
              const Eigen::Isometry3d& T_CW, const Eigen::Matrix<double, 6, 1>& velocity);

  bool estimated() const { return options_.prior_sigma > 0.0; }
  double value() const { return state_[0]; }  ///< tau [s]; > 0: the right image is late
  double sigma() const;                       ///< its standard deviation [s]
  /// What it costs: |tau| times the median flow along the rows, over the median disparity; of the
  /// frames that are remembered the mean. Share of the depth.
  double depth_error() const;
  /// Standard deviation of what it costs, as far as it is known: sqrt(tau^2 + sigma^2) in place of
  /// |tau|. Share of the depth, zero while the camera has not moved.
  double depth_sigma() const;
  /// Whether it is known to cost more than max_error: four standard deviations from zero.
  bool out_of_step() const;
  /// "the right camera is 20 ms late"; where that is a whole number of `period`s [s] (0: not
  /// known), that the pairs are shifted by so many frames.
  std::string reason(double period) const;

 private:
  using Vector4d = Eigen::Matrix<double, 4, 1>;
  using Matrix4d = Eigen::Matrix<double, 4, 4>;

  CameraTimeOffsetOptions options_;
  Matrix4d prior_ = Matrix4d::Zero(), information_ = Matrix4d::Zero();
  Vector4d right_hand_side_ = Vector4d::Zero();
  Vector4d state_ = Vector4d::Zero();  // (tau [s], c_0, c_1, c_2 [px])
  double flow_ = 0.0, frames_ = 0.0;   // sum of flow over disparity [1/s], and of frames
};

}  // namespace prospect
