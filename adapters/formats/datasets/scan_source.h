// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/recording_source.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

struct ScanOptions {
  std::map<std::string, std::string> topics;  ///< of a bag: "scan", "pose"; others are found
  std::string fixed_frame;                    ///< of a bag, as BagPoseChoice
};

/// A recording of a lidar: scans of one plane or clouds of points, each with the pose of the lidar.
/// Scans are read one by one.
struct ScanSource : RecordingSource {
  std::string from;              ///< topic or file
  std::string fixed;             ///< what the poses are in, for messages
  bool planar = true;            ///< scans of one plane; else clouds
  double max_range = 0.0;        ///< of the lidar, as the first scan states it [m]; 0: not stated
  std::size_t points = 0;        ///< beams or points of the first scan
  std::size_t scans = 0;         ///< with and without a pose
  std::vector<double> stamps;    ///< of those with a pose, increasing [s]
  DepthPoses poses;              ///< lidar to the fixed frame, z up
  std::size_t without_pose = 0;  ///< scans left out
  /// Scan i in the lidar's frame. Throws InputError where it cannot be read.
  std::function<DepthScan(std::size_t i)> read;
};

using ScanLayout = RecordingLayout<ScanSource, ScanOptions>;

/// All layouts, in the order in which they are asked.
const std::vector<ScanLayout>& scan_layouts();

/// The first layout that recognises the path; null: none does.
const ScanLayout* find_scan_layout(const std::string& path);

/// Whether a recording is used for its scans: it is a log, or a bag in which "scan" is chosen, or
/// that has scans and no depth images and in which no images are chosen. Throws InputError if the
/// bag cannot be read.
bool is_used_for_scans(const std::string& path, const std::map<std::string, std::string>& topics);

/// Opens with the layout that fits. Throws InputError if none does: what was looked for.
ScanSource open_scan_source(const std::string& path, const ScanOptions& options = {});

// The layouts, one a file.
/// Topics of a bag of ROS 2 (bag_file.h): sensor_msgs/msg/LaserScan or PointCloud2.
ScanSource open_scan_bag(const std::string& path, const ScanOptions& options);
/// A log of CARMEN, the text of public 2-D data sets (layout_carmen.cc).
bool is_carmen_log(const std::string& path);
ScanSource open_carmen_log(const std::string& path, const ScanOptions& options);

}  // namespace prospect
