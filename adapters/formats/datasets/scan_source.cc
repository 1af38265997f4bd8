// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/scan_source.h"

#include <algorithm>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_topics.h"

namespace prospect {

const std::vector<ScanLayout>& scan_layouts() {
  static const std::vector<ScanLayout> layouts = {
      {"ROS 2 bag", "a .mcap or .db3 file with LaserScan or PointCloud2 (ROS 2 bag)", is_bag,
       open_scan_bag},
      {"CARMEN log", "a .log, .clf or .carmen file with FLASER or ROBOTLASER1 lines (CARMEN)",
       is_carmen_log, open_carmen_log},
  };
  return layouts;
}

const ScanLayout* find_scan_layout(const std::string& path) {
  return find_layout(scan_layouts(), path);
}

bool is_used_for_scans(const std::string& path, const std::map<std::string, std::string>& topics) {
  if (find_scan_layout(path) == nullptr) return false;
  if (!is_bag(path) || topics.contains("scan")) return true;
  if (topics.contains("depth") || topics.contains("left")) return false;
  const BagFile bag = BagFile::open(path);
  return find_depth_topic(bag).topic == nullptr &&
         std::any_of(bag.topics().begin(), bag.topics().end(), is_scan_topic);
}

ScanSource open_scan_source(const std::string& path, const ScanOptions& options) {
  const ScanLayout* layout = find_scan_layout(path);
  if (layout == nullptr) {
    throw InputError(path + ": no recording of a lidar is there; looked for " +
                     looked_for(scan_layouts(), ", ") + "; expected one of these");
  }
  return layout->open(path, options);
}

}  // namespace prospect
