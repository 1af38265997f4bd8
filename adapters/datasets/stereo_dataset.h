#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "adapters/datasets/rectification.h"
#include "adapters/datasets/trajectory.h"
#include "models/camera.h"
#include "perception/image.h"

namespace prospect {

/// A recording of a stereo pair, opened and checked; frames are read one by one, rectified.
///
/// Layouts, told apart by what the folder holds:
///   KITTI odometry  `calib.txt` (P0, P1 named, or two rows of twelve numbers), images in image_0
///   and
///                   image_1 (or image_l and image_r), `times.txt` [s] (absent: 10 Hz), ground
///                   truth `poses.txt` or `../../poses/NAME.txt`, of the left camera. Rectified.
///   EuRoC           `mav0/cam0`, `mav0/cam1` with `sensor.yaml` (pinhole, radial-tangential) and
///                   `data/STAMP.png` [ns]; ground truth `groundtruth_tum.txt` or
///                   `mav0/state_groundtruth_estimate0/data.csv`, of the body. Rectified here.
/// Frames that only one camera has are left out; more than a fifth of them is an error.
class StereoDataset {
 public:
  /// Throws InputError, one line for each problem: what is missing, misnamed, malformed or does not
  /// fit together; also where the first pair contradicts the calibration: a size that does not fit,
  /// a baseline that is not 0.01 to 2 m to the right, left and right exchanged, rows that do not
  /// correspond (perception/stereo_check.h). A wrong scale of the baseline within that range cannot
  /// be seen in images; compare with the ground truth's length where there is one.
  static StereoDataset open(const std::string& folder);

  const std::string& layout() const { return layout_; }
  const StereoCamera& camera() const { return camera_; }
  int size() const { return static_cast<int>(stamps_.size()); }
  double stamp(int i) const { return stamps_[i]; }  ///< [s]
  int unpaired() const { return unpaired_; }        ///< frames that only one camera has
  bool times_assumed() const { return times_assumed_; }

  struct Pair {
    Image left, right;
  };
  /// Throws InputError if an image cannot be decoded or has another size than the first.
  Pair read(int i) const;

  /// Poses of the rectified left camera; empty: not known.
  const Trajectory& ground_truth() const { return ground_truth_; }

 private:
  void open_kitti(const std::string& folder);
  void open_euroc(const std::string& folder);
  void check_first_pair(const std::string& folder);

  std::string layout_;
  StereoCamera camera_;
  std::vector<double> stamps_;
  std::vector<std::string> left_, right_;
  int unpaired_ = 0;
  bool times_assumed_ = false;
  Trajectory ground_truth_;
  std::shared_ptr<const Rectification> rectification_;  // null: rectified already
};

}  // namespace prospect
