#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "models/camera.h"
#include "perception/depth_image.h"

namespace prospect {

struct DepthDatasetOptions {
  /// Intrinsics where no file states them; width and height are those of the images.
  std::optional<PinholeCamera> camera;
  DepthRange range;  ///< depths outside are invalid [m]
};

/// A recording of depth images, opened and checked; images are read one by one.
///
/// Layouts, told apart by what the folder holds:
///   7-Scenes   `frame-NNNNNN.depth.png` [mm], `frame-NNNNNN.pose.txt` (4 x 4, camera to world; all
///              frames have one, or none)
///   TUM RGB-D  `depth.txt` (`stamp path` a line), images in 1/5000 m, `groundtruth.txt`; a frame
///              without a pose within 20 ms is left out, and counted
///   numbered   `depth/NNN.png` [mm], as robots record them: no poses
/// Images are 16-bit grey; 0 and 65535 are invalid. Intrinsics: `camera-intrinsics.txt` (3 x 3), or
/// as given. Where frames are only numbered, 30 a second are assumed, and said to be.
class DepthDataset {
 public:
  /// Throws InputError, one line: what is missing, misnamed, malformed or does not fit together;
  /// intrinsics both in a file and given, or neither.
  static DepthDataset open(const std::string& folder, const DepthDatasetOptions& options = {});

  const std::string& layout() const { return layout_; }
  const PinholeCamera& camera() const { return camera_; }
  int size() const { return static_cast<int>(images_.size()); }
  double stamp(int i) const { return stamps_[static_cast<std::size_t>(i)]; }  ///< [s]
  bool times_assumed() const { return times_assumed_; }
  int without_pose() const { return without_pose_; }  ///< frames left out
  bool has_poses() const { return !poses_.empty(); }
  /// Camera to the recording's world, whose axes may point anywhere; requires has_poses().
  const Eigen::Isometry3d& pose(int i) const { return poses_[static_cast<std::size_t>(i)]; }

  /// Throws InputError if the image cannot be decoded or has another size than the first.
  DepthImage read(int i) const;

 private:
  void open_seven_scenes(const std::string& folder);
  void open_tum(const std::string& folder);
  void open_numbered(const std::string& folder);

  std::string layout_;
  PinholeCamera camera_;
  DepthRange range_;
  double unit_ = 0.001;  ///< [m]
  std::vector<double> stamps_;
  std::vector<std::string> images_;
  std::vector<Eigen::Isometry3d, Eigen::aligned_allocator<Eigen::Isometry3d>> poses_;
  bool times_assumed_ = false;
  int without_pose_ = 0;
};

}  // namespace prospect
