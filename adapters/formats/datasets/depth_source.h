// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/image_stream.h"
#include "adapters/formats/datasets/recording_source.h"
#include "models/camera.h"
#include "perception/mapping/depth_image.h"

namespace prospect {

struct DepthDatasetOptions {
  /// Intrinsics where no file states them; width and height are those of the images.
  std::optional<PinholeCamera> camera;
  DepthRange range;         ///< depths outside are invalid [m]
  std::string calibration;  ///< file that states the intrinsics, a ROS camera_info; empty: none
  /// Numbers of the images a metre; none: the layout's, checked against what else is known
  /// (depth_scale.h).
  std::optional<double> depth_scale;
  double camera_height =
      0.0;  ///< above the floor in the first frames, to check with [m]; 0: unknown
  /// Of a bag: "depth", "depth_info", "pose" to topics; others are found. "depth_1", "depth_2",
  /// ...: of other cameras.
  std::map<std::string, std::string> topics;
  std::string fixed_frame;  ///< of a bag, as BagPoseChoice
};

using DepthPoses = std::vector<Eigen::Isometry3d, Eigen::aligned_allocator<Eigen::Isometry3d>>;

/// What depths that were measured by stereo are worth (perception/mapping/stereo_depth.h).
struct StereoDepthAccuracy {
  DepthRange range;
  double noise = 0.0;  ///< the standard deviation of a depth z is noise z^2 [1/m]
};

/// Another depth camera of the same rig, which does not move against the first.
struct MoreDepthImages {
  ImageStream images;
  DepthPoses poses;  ///< of the first camera at the stamps of these images, as DepthSource::poses
  PinholeCamera camera;                                    ///< width and height 0: not stated
  std::string camera_from;                                 ///< topic, for messages
  Eigen::Isometry3d T_FC = Eigen::Isometry3d::Identity();  ///< this camera to the first
};

/// What a layout finds in a recording of depth images.
struct DepthSource : RecordingSource {
  ImageStream images;
  DepthPoses poses;  ///< of each image, camera to world; empty: none is known
  /// The poses' quaternions have no names in the file: w, which is last by rule, may be first.
  bool poses_of_quaternions = false;
  std::optional<PinholeCamera> camera;        ///< width and height 0: not stated
  std::string camera_from;                    ///< file or topic, for messages
  double depth_scale = 1000.0;                ///< numbers a metre by the layout's rule, of 16 bits
  int without_pose = 0;                       ///< frames left out
  std::optional<StereoDepthAccuracy> stereo;  ///< none: the images hold another sensor's depths
  std::vector<MoreDepthImages> more;          ///< of other cameras; requires poses
};

using DepthLayout = RecordingLayout<DepthSource, DepthDatasetOptions>;

/// All layouts, in the order in which they are asked.
const std::vector<DepthLayout>& depth_layouts();

/// The first layout that recognises the path; null: none does.
const DepthLayout* find_depth_layout(const std::string& path);

/// Opens with the layout that fits, and finds the intrinsics. Throws InputError if the path is
/// absent or no layout fits: what was looked for.
DepthSource open_depth_source(const std::string& path, const DepthDatasetOptions& options = {});

// The layouts, one a file.
/// Topics of a bag of ROS 2 (bag_file.h).
DepthSource open_depth_bag(const std::string& path, const DepthDatasetOptions& options);
bool is_tum_rgbd(const std::string& path);
DepthSource open_tum_rgbd(const std::string& path, const DepthDatasetOptions& options);
bool is_seven_scenes(const std::string& path);
DepthSource open_seven_scenes(const std::string& path, const DepthDatasetOptions& options);
bool is_numbered_depth(const std::string& path);
DepthSource open_numbered_depth(const std::string& path, const DepthDatasetOptions& options);

}  // namespace prospect
