// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/maps/landmark_map.h"
#include "engine/maps/localization.h"
#include "models/image.h"
#include "perception/odometry/motion_in_view.h"

namespace prospect {

/// Times of one frame [ms]; the only numbers that differ between two runs.
struct OdometryTimes {
  double pyramids = 0.0, tracking = 0.0, pose = 0.0, keyframe = 0.0;  ///< on the wall clock
  /// Of the processor, for all of it: what the frame costs where others keep the machine busy.
  double processor = 0.0;
};

struct OdometryFrame {
  double stamp = 0.0;  ///< [s]
  Localization state = Localization::kLost;
  /// Why the state is not ok, several reasons joined by "; ". Empty if ok.
  std::string reason;
  /// Pose of the left camera in W. Lost: the last pose that was trusted.
  Eigen::Isometry3d T_WC = Eigen::Isometry3d::Identity();
  /// Of xi = (t, omega) in C with T_CW <- exp(xi) T_CW, against the first pose (pose_drift.h).
  /// Grows while lost.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Likewise of the motion since the newest keyframe before this frame; zero if none was measured.
  Eigen::Matrix<double, 6, 6> covariance_since_keyframe = Eigen::Matrix<double, 6, 6>::Zero();
  bool keyframe = false;
  bool restarted = false;  ///< a new map begins here: the pose may be off by any motion while lost
  std::string keyframe_reason;
  int expected = 0;   ///< landmarks predicted in view
  int tracked = 0;    ///< landmarks that were found and agree with the pose
  int confirmed = 0;  ///< of them, those the right image confirms
  int matched = 0;    ///< landmarks entered at this frame
  double chi2_per_dof = 0.0;
  /// Median row error of the stereo matches of the newest keyframe [px]: health of the calibration.
  double row_error = 0.0;
  /// Error of the calibration found by motion (disparity_offset.h), already corrected [px].
  double disparity_offset = 0.0;
  double disparity_offset_sigma = 0.0;
  /// By how much later the right image is taken than the left one (camera_time_offset.h) [s]; not
  /// corrected. Not known: zero, with the deviation that is expected of cameras.
  bool camera_time_offset_known = false;
  double camera_time_offset = 0.0;
  double camera_time_offset_sigma = 0.0;
  /// Standard deviation of what all depths may be wrong by, for it is not corrected; share of them.
  double camera_time_offset_depth = 0.0;
  /// That it makes depths wrong by more than is to be borne, in words; empty: it does not.
  std::string out_of_step;
  OdometryTimes times;
};

/// A landmark that was to be seen at a frame.
struct LandmarkSighting {
  std::uint64_t id = 0;
  /// [px] Where the left image shows it; where it was expected if it was not tracked.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  bool tracked = false;  ///< found, and agrees with the pose
  bool made = false;     ///< at this frame; then it is tracked
};

/// What an odometry would claim of a motion that is to come.
struct MotionAhead {
  Eigen::Isometry3d T_CC = Eigen::Isometry3d::Identity();  ///< C then, in C now
  Eigen::Matrix<double, 6, 6> covariance;                  ///< as of covariance_since()
  int tracked = 0;                                         ///< landmarks that it would see
};

/// Visual odometry: rectified stereo pairs in, poses of the left camera C and landmarks out, both
/// in W. What fusion, mapping and the planner's belief are made from asks no more of it.
///
/// process() never throws for any image: what it cannot use makes the frame lost, with the reason.
/// Thread-safety: one thread calls process(); landmarks() snapshots may be read anywhere.
class Odometry {
 public:
  virtual ~Odometry() = default;

  /// One rectified pair of the camera's size, stamps increasing [s]. `motion`: the pose of C now in
  /// C at the newest frame before this that was not lost and tracked something, as others measured
  /// it, wheels for instance (VisualMotionReader::camera_motion). Only where landmarks are looked
  /// for depends on it, but of a texture that repeats itself that decides which one is found; one
  /// that is wrong costs time, if the images can tell. Without it, and if it is not finite, the
  /// robot is taken to go on as it did.
  virtual OdometryFrame process(double stamp, const ImageView& left, const ImageView& right,
                                const std::optional<Eigen::Isometry3d>& motion) = 0;

  /// Likewise of an IMU, which measures the turn, but the way only as far as the velocity is known:
  /// for the next call of process() alone, where nobody tells its `motion`. It says nothing of
  /// whether the camera rests.
  virtual void expect(const std::optional<Eigen::Isometry3d>& motion) { (void)motion; }

  /// The landmarks that are tracked now or were of late, in W. The survival of each is the
  /// probability that it is tracked `horizon` [s] ahead if it is in view until then.
  virtual std::shared_ptr<const LandmarkMap> landmarks(double horizon) const = 0;

  /// Landmarks in view of the newest frame; empty where no pose was measured.
  virtual const std::vector<LandmarkSighting>& sightings() const = 0;
  /// Those of them, all tracked, that are given up from now on: another, older one stands in the
  /// same image cell.
  virtual const std::vector<std::uint64_t>& given_up() const = 0;

  /// Covariance of the motion since the frame that was processed `frames` before the newest, of
  /// e = (t, omega) in C with T_CC' <- exp(e) T_CC', C' the camera then. What both poses owe to the
  /// same landmarks does not count. Nothing where it is not known.
  virtual std::optional<Eigen::Matrix<double, 6, 6>> covariance_since(int frames) const {
    (void)frames;
    return std::nullopt;
  }

  /// A motion along C's axis by a tenth of the distance of what is in view, as the landmarks that
  /// are there would measure it. Nothing where it is not known.
  virtual std::optional<MotionAhead> motion_ahead() const { return std::nullopt; }

  /// Landmarks of what moves against the world at the newest frame, and of the world, in C.
  virtual MotionInView motion_in_view() const { return {}; }
};

}  // namespace prospect
