// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/datasets/frame_pairs.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/datasets/trajectory.h"
#include "models/camera.h"
#include "models/image.h"
#include "perception/odometry/rectification.h"

namespace prospect {

/// A recording of a stereo pair, opened and checked; frames are read one by one, grey, 8 bits,
/// rectified. Layouts: stereo_layouts() in stereo_source.h, told apart by what is there; each
/// describes itself in docs/reference/perception.md.
///
/// Images are grey or colour, of 8 or 16 bits. What the numbers of 16 bits hold is the least of 8,
/// 10, 12, 14 and 16 bits that some images along the recording need; the upper 8 of these are used,
/// in all images alike, and notes() says so. Frames that only one camera has are left out
/// (frame_pairs.h).
class StereoDataset {
 public:
  /// Throws InputError, one line: what is missing, misnamed, malformed or does not fit together;
  /// also where pairs contradict the calibration: a size that does not fit, a baseline
  /// that is not 0.01 to 2 m to the right, left and right exchanged, rows that do not correspond
  /// (perception/odometry/stereo_check.h). A wrong scale of the baseline within that range cannot
  /// be seen in images; compare with the ground truth's length where there is one.
  static StereoDataset open(const std::string& path, const StereoDatasetOptions& options = {});
  /// Likewise, of what open_stereo_source() has found with these options.
  static StereoDataset open(StereoSource source, const StereoDatasetOptions& options);

  const std::string& layout() const { return layout_; }
  const StereoCamera& camera() const { return camera_; }
  int size() const { return static_cast<int>(stamps_.size()); }
  double stamp(int i) const { return stamps_[i]; }  ///< of the left image [s]
  int unpaired() const { return unpaired_; }        ///< frames that only one camera has
  bool times_assumed() const { return times_assumed_; }
  /// What was assumed, chosen or left out, one line each.
  const std::vector<std::string>& notes() const { return notes_; }

  using Pair = ImagePair;
  /// Throws InputError if an image cannot be decoded or has another size than the first: this pair
  /// is bad, not the recording (elements.h).
  Pair read(int i) const;

  /// Poses of the rectified left camera; empty: not known.
  const Trajectory& ground_truth() const { return ground_truth_; }
  /// The same if w were first in its file's quaternions; empty where their order is stated.
  const Trajectory& ground_truth_w_first() const { return ground_truth_w_first_; }

  /// Its R_BS: the axes of its sensor in the rectified left camera; empty: there is none.
  const ImuRecording& imu() const { return imu_; }

 private:
  std::pair<RawImage, RawImage> first_readable_pair() const;
  void rectify(StereoCalibration calibration, const RawImage& first);
  void find_bits();
  void check_pairs(const std::string& wrong_side);
  Image read_grey(const ImageStream& camera, std::size_t i) const;

  std::string layout_;
  StereoCamera camera_;
  std::vector<double> stamps_;
  ImageStream left_, right_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  int unpaired_ = 0;
  int bits_ = 8;
  bool times_assumed_ = false;
  std::vector<std::string> notes_;
  std::string calibration_from_;
  Trajectory ground_truth_, ground_truth_w_first_;
  ImuRecording imu_;
  std::shared_ptr<const Rectification> rectification_;  // null: rectified already
};

}  // namespace prospect
