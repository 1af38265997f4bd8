// SPDX-License-Identifier: Apache-2.0
// Bags of ROS 2: scans of lidars and clouds of points, with poses from topics or TF.

#include <memory>
#include <utility>

#include "adapters/formats/datasets/bag_poses.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/datasets/scan_source.h"

namespace prospect {
namespace {

/// Scans before clouds; of each the topic with most messages. The others are named.
const BagTopic* find_scan_topic(const BagFile& bag, std::vector<std::string>& notes) {
  const BagTopic* best = nullptr;
  for (const BagTopic& topic : bag.topics()) {
    if (!is_scan_topic(topic) || topic.messages.empty()) continue;
    const auto rank = [](const BagTopic& t) {
      return std::pair(is_laser_scan(t), t.messages.size());
    };
    if (best == nullptr || rank(topic) > rank(*best)) best = &topic;
  }
  if (best == nullptr) return nullptr;
  std::string others;
  for (const BagTopic& topic : bag.topics()) {
    if (&topic != best && is_scan_topic(topic) && !topic.messages.empty()) {
      others += (others.empty() ? "; not used: " : ", ") + topic.name;
    }
  }
  notes.push_back("topic scan=" + best->name + ", by its type" + others);
  return best;
}

/// How the lidar moved while it took the scan; the identity where that is not known.
Eigen::Isometry3d motion_during(const RosLaserScan& scan, double stamp, const BagPoses& poses) {
  const double last = static_cast<double>(scan.ranges.size()) - 1.0;
  if (scan.time_increment == 0.0 || last < 1.0) return Eigen::Isometry3d::Identity();
  const auto T_begin = poses.at(stamp), T_end = poses.at(stamp + last * scan.time_increment);
  if (!T_begin || !T_end) return Eigen::Isometry3d::Identity();
  return T_begin->inverse() * *T_end;
}

}  // namespace

ScanSource open_scan_bag(const std::string& path, const ScanOptions& options) {
  ScanSource source;
  source.layout = "ROS 2 bag";
  const BagFile bag = BagFile::open(path);
  source.notes = bag.notes();
  source.attempt([&] {
    check_encodings(bag, path);
    const BagTopic* topic = given_topic(bag, path, options.topics, "scan", is_scan_topic);
    if (topic == nullptr) topic = find_scan_topic(bag, source.notes);
    if (topic == nullptr) {
      throw InputError(
          path + ": no topic is a LaserScan or PointCloud2; expected one of: " + topic_list(bag));
    }
    source.from = topic->name;
    source.planar = is_laser_scan(*topic);
    const auto stamped = stamped_messages(bag, *topic, "scans", source.notes);
    source.scans = stamped.size();
    if (stamped.empty()) throw InputError(topic->name + ": holds no message; expected scans");
    Elements scans("scans");
    for (const auto& [stamp, i] : stamped) {
      if (scans.read([&, i = i] {
            const std::string bytes = read_message(bag, *topic, i), name = message_name(*topic, i);
            if (!source.planar) {
              source.points = read_ros_point_cloud(bytes, name).size();
              return;
            }
            const RosLaserScan scan = read_ros_laser_scan(bytes, name);
            source.max_range = std::isfinite(scan.range_max) ? scan.range_max : 0.0;
            source.points = scan.ranges.size();
          })) {
        break;
      }
      if (scans.bad() == static_cast<int>(stamped.size())) throw InputError(scans.first());
    }
    const std::string frame = frame_of(bag, *topic);
    const auto poses =
        find_bag_poses(bag, path, {options.topics, options.fixed_frame}, frame, source.notes);
    if (!poses) {
      throw InputError(
          path + ": no pose of the lidar's frame '" + frame +
          "' is in the bag; expected transforms (/tf, /tf_static) that lead to a frame "
          "that it moves in, or a topic of Odometry or PoseStamped");
    }
    source.fixed = poses->from();
    std::vector<double> stamps;
    for (const auto& message : stamped) stamps.push_back(message.first);
    PosedStamps posed = stamps_with_poses(*poses, stamps, "scan", topic->name, path, source.notes);
    source.without_pose = static_cast<std::size_t>(posed.without);
    source.poses.assign(posed.poses.begin(), posed.poses.end());
    std::vector<std::size_t> order;  // of the messages
    for (const std::size_t k : posed.order) {
      source.stamps.push_back(stamped[k].first);
      order.push_back(stamped[k].second);
    }
    source.read = [bag, &topic = *topic, order, stamps = source.stamps, poses = *poses,
                   planar = source.planar](std::size_t k) {
      const std::string bytes = read_message(bag, topic, order.at(k));
      const std::string message = message_name(topic, order[k]);
      if (planar) {
        const RosLaserScan scan = read_ros_laser_scan(bytes, message);
        return rays_of(scan, motion_during(scan, stamps[k], poses));
      }
      DepthScan scan;
      scan.hits = read_ros_point_cloud(bytes, message);
      return scan;
    };
  });
  return source;
}

}  // namespace prospect
