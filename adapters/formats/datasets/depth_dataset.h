// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/depth_scale.h"
#include "adapters/formats/datasets/depth_source.h"
#include "models/camera.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

/// A recording of depth images, opened and checked; images are read one by one.
///
/// Layouts: depth_layouts() in depth_source.h, told apart by what is there;
/// docs/reference/mapping.md describes them. Images are 16-bit grey, of which 0 and 65535 are
/// invalid, or 32-bit floats (TIFF, PFM), of which what is not positive and finite is invalid.
/// Intrinsics: `camera-intrinsics.txt` (3 x 3), or as given. Where frames are only numbered, 30 a
/// second are assumed, and said to be.
class DepthDataset {
 public:
  /// Throws InputError, one line: what is missing, misnamed, malformed or does not fit together;
  /// intrinsics both in a file and given, or neither.
  static DepthDataset open(const std::string& path, const DepthDatasetOptions& options = {});
  /// Likewise, of what was found with these options.
  static DepthDataset open(DepthSource source, const DepthDatasetOptions& options);

  const std::string& layout() const { return layout_; }
  /// Of image i: 0, or which of the other cameras it is of, from 1 on.
  int sensor(int i) const { return sensors_[static_cast<std::size_t>(i)]; }
  int sensors() const { return static_cast<int>(cameras_.size()); }
  const PinholeCamera& camera(int sensor = 0) const { return cameras_.at(as_index(sensor)).camera; }
  /// That camera to the first.
  const Eigen::Isometry3d& T_FC(int sensor) const { return cameras_.at(as_index(sensor)).T_FC; }
  int size() const { return static_cast<int>(images_.size()); }
  double stamp(int i) const { return images_.stamps[static_cast<std::size_t>(i)]; }  ///< [s]
  bool times_assumed() const { return times_assumed_; }
  int without_pose() const { return without_pose_; }       ///< frames left out
  double depth_scale() const { return scale_.per_metre; }  ///< numbers of an image a metre
  /// What is known contradicts the depth scale; the note says what.
  bool depth_scale_doubtful() const { return scale_.doubtful; }
  /// None: the images hold another sensor's depths.
  const std::optional<StereoDepthAccuracy>& stereo() const { return stereo_; }
  /// What was assumed, chosen or left out, one line each.
  const std::vector<std::string>& notes() const { return notes_; }
  bool has_poses() const { return !poses_.empty(); }
  /// First camera to the recording's world, whose axes may point anywhere, at the time of image i;
  /// requires has_poses().
  const Eigen::Isometry3d& pose(int i) const { return poses_[static_cast<std::size_t>(i)]; }

  /// Throws InputError if the image cannot be decoded, holds no depth or has another size than the
  /// first: it is bad, not the recording (elements.h).
  DepthImage read(int i) const;

 private:
  struct Camera {
    PinholeCamera camera;
    Eigen::Isometry3d T_FC = Eigen::Isometry3d::Identity();
  };
  static std::size_t as_index(int i) { return static_cast<std::size_t>(i); }
  RawImage read_raw(std::size_t i) const;
  void add(std::vector<MoreDepthImages> more);

  std::string layout_;
  std::vector<Camera> cameras_;
  std::vector<int> sensors_;  // of each image
  DepthRange range_;
  DepthScale scale_;
  ImageStream images_;
  DepthPoses poses_;
  std::vector<std::string> notes_;
  bool times_assumed_ = false;
  int without_pose_ = 0;
  std::optional<StereoDepthAccuracy> stereo_;
};

}  // namespace prospect
