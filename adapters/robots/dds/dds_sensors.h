// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "models/camera.h"
#include "runtime/image_sink.h"

namespace prospect {

/// What a LaserScan says of its lidar: beams in one plane.
struct DdsLidar {
  double field_of_view = 0.0;               ///< [rad], up to 2 pi
  double min_range = 0.0, max_range = 0.0;  ///< [m]
  CameraMount mount;                        ///< along the middle of its beams, in frames.base by tf
};

/// What the robot's topics say of its cameras and its lidar.
struct DdsCameras {
  std::optional<StereoCamera> stereo;  ///< as the inbox gets the images: rectified; none: no pair
  std::optional<PinholeCamera> depth;  ///< none: no depth images
  std::optional<DdsLidar> lidar;       ///< of a robot with scans and no depth images
  /// In frames.base by tf; none: the robot's description says where they are.
  std::optional<CameraMount> stereo_mount, depth_mount;
  // Of the depth sensors from 1 on, by their number.
  std::map<int, PinholeCamera> more_depth{};
  std::map<int, DdsLidar> more_lidars{};     ///< of scans
  std::map<int, CameraMount> more_mounts{};  ///< of depth cameras by tf
};

/// The sensors of a robot behind topics of ROS 2: images become grey and rectified, depths metres,
/// scans and clouds rays in B, and all is handed on with the stamps of its headers.
///
/// A message that does not fit (encoding, size other than its camera_info's, bytes that end early,
/// an image of a camera whose camera_info has changed since wait(), a lidar whose frame tf does not
/// know at the scan's stamp) is left out, and is a fault of its
/// topic (DdsNode::fault()) until a good one comes.
///
/// Declares its topics on the node: make it before DdsNode::start(). Throws InputError if images
/// come compressed and OpenCV's codecs cannot be loaded. `frames`, transforms and node
/// must outlive it, and the first two the node's thread. Thread-safety: any thread.
class DdsSensors {
 public:
  DdsSensors(const DdsOptions& options, DdsNode& node, DdsTransforms& transforms,
             ImageSink& frames);
  ~DdsSensors();

  /// Waits until calibrations, a scan of a robot without depth images, and the transforms that are
  /// asked for, have come; images count from
  /// then on, and cameras that tf tells of must stay where they are (DdsTransforms::hold()). Throws
  /// InputError, a line for each that did not come within options.timeout, or that cannot be.
  DdsCameras wait() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  // shared with the handlers
};

}  // namespace prospect
