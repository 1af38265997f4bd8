// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "adapters/formats/datasets/transform_tree.h"

namespace prospect {

/// What is asked of the poses in a bag.
struct BagPoseChoice {
  TopicChoice topics;       ///< "pose"
  std::string fixed_frame;  ///< of TF, in which the poses are wanted; empty: chosen
};

/// Where a sensor was, at any time of a bag of ROS 2: by a topic of poses, moved to the sensor by
/// TF, or by TF alone. Copies share what was read.
class BagPoses {
 public:
  /// The poses of a topic (nav_msgs/msg/Odometry, geometry_msgs/msg/PoseStamped or
  /// TransformStamped); those of no named frame are taken for the sensor's. Throws InputError where
  /// `tree` does not lead from their frame to `sensor`. Says in `notes` what was assumed.
  static BagPoses of_topic(const BagFile& bag, const BagTopic& topic,
                           std::shared_ptr<const TransformTree> tree, const std::string& sensor,
                           std::vector<std::string>& notes);
  /// Poses in a frame of TF.
  static BagPoses of_frame(std::shared_ptr<const TransformTree> tree, const std::string& fixed,
                           const std::string& sensor);

  /// Sensor to the fixed frame; none where it is not known: no pose within 0.25 s, or no transform
  /// within 1 s, on both sides, or one of the two is none (NaN, a quaternion of zeros).
  std::optional<Eigen::Isometry3d> at(double stamp) const;
  /// Of the topic's poses; empty for TF.
  std::vector<double> stamps() const;
  const std::string& from() const { return from_; }  ///< for messages: "/odom", "TF map to base"

 private:
  std::shared_ptr<const TransformTree> tree_;
  Trajectory poses_;   // of body_ in the fixed frame; empty: TF alone
  std::string fixed_;  // of TF alone
  std::string body_;   // empty: the sensor itself
  std::string sensor_;
  std::string from_;
};

/// All transforms of a bag, of /tf, /tf_static and other topics of tf2_msgs/msg/TFMessage; those
/// whose topic's name ends in "static" hold at all times. Says in `notes` which contradict others.
std::shared_ptr<const TransformTree> read_transforms(const BagFile& bag,
                                                     std::vector<std::string>& notes);

/// The poses of a sensor: by the topic or the fixed frame that is given; else by TF from "map";
/// else by the first topic of poses, Odometry before others; else by TF from "odom", "world" or
/// whatever is above the sensor, as long as it moves. None: the bag holds no pose. Throws
/// InputError where what was given is not there or does not lead to the sensor. Says in `notes`
/// what was chosen.
std::optional<BagPoses> find_bag_poses(const BagFile& bag, const std::string& path,
                                       const BagPoseChoice& choice, const std::string& sensor,
                                       std::vector<std::string>& notes);

/// Those of `stamps` at which a pose is known.
struct PosedStamps {
  std::vector<std::size_t> order;        ///< which they are
  std::vector<Eigen::Isometry3d> poses;  ///< parallel
  int without = 0;                       ///< how many have none, which `notes` say, too
};
/// `what` has them, of `topic`: "image", "scan". Throws InputError where none has a pose.
PosedStamps stamps_with_poses(const BagPoses& poses, const std::vector<double>& stamps,
                              const std::string& what, const std::string& topic,
                              const std::string& path, std::vector<std::string>& notes);

}  // namespace prospect
