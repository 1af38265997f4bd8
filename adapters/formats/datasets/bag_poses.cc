// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/bag_poses.h"

#include <map>
#include <set>
#include <utility>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/files/input_error.h"

namespace prospect {
namespace {

constexpr double kLongestGap = 0.25;  // between poses of a topic [s]
constexpr double kSamePlace = 1e-4;   // of transforms that are told twice

}  // namespace

std::shared_ptr<const TransformTree> read_transforms(const BagFile& bag,
                                                     std::vector<std::string>& notes) {
  auto tree = std::make_shared<TransformTree>();
  std::map<std::string, std::string> contradicted;
  std::set<std::string> told_otherwise;
  std::size_t unset = 0;
  Elements transforms("transforms of TF");
  for (const BagTopic& topic : bag.topics()) {
    if (!is_of_type(topic, "tf2_msgs/msg/TFMessage")) continue;
    const bool fixed = topic.name.ends_with("static");
    for (std::size_t i = 0; i < topic.messages.size(); ++i) {
      const double recorded = static_cast<double>(topic.messages[i].time) * 1e-9;
      for (const RosTransform& t :
           read_ros_transforms(read_message(bag, topic, i), message_name(topic, i), transforms)) {
        if (fixed && !is_known(t.T)) continue;
        const bool stamped = fixed || t.stamp > 0.0;
        unset += !stamped;
        const auto before = fixed ? tree->find(t.parent, t.child, 0.0) : std::nullopt;
        if (before && !before->isApprox(t.T, kSamePlace)) told_otherwise.insert(t.child);
        const bool added = fixed ? tree->add_static(t.parent, t.child, t.T)
                                 : tree->add(t.parent, t.child, stamped ? t.stamp : recorded, t.T);
        if (!added) contradicted[t.child] = t.parent;
      }
    }
  }
  transforms.finish(notes);
  if (unset > 0) {
    notes.push_back("TF: " + std::to_string(unset) +
                    " transforms without a stamp: the time of recording stands for it");
  }
  for (const std::string& child : told_otherwise) {
    notes.push_back("TF: " + child + " in " + tree->parent(child) +
                    " is told to be fixed at two places; the newest counts");
  }
  for (const auto& [child, parent] : contradicted) {
    notes.push_back("TF: " + child + " in " + parent + " contradicts the tree, where it is in " +
                    tree->parent(child) + "; left out");
  }
  return tree;
}

BagPoses BagPoses::of_frame(std::shared_ptr<const TransformTree> tree, const std::string& fixed,
                            const std::string& sensor) {
  BagPoses poses;
  poses.tree_ = std::move(tree);
  poses.fixed_ = fixed;
  poses.sensor_ = sensor;
  poses.from_ = "TF " + fixed + " to " + sensor;
  return poses;
}

BagPoses BagPoses::of_topic(const BagFile& bag, const BagTopic& topic,
                            std::shared_ptr<const TransformTree> tree, const std::string& sensor,
                            std::vector<std::string>& notes) {
  BagPoses poses;
  poses.tree_ = std::move(tree);
  poses.sensor_ = sensor;
  poses.from_ = topic.name;
  Elements elements("poses of " + topic.name);
  std::optional<RosTransform> first;
  for (const auto& [stamp, i] : stamped_messages(bag, topic, "poses", notes)) {
    RosTransform pose;
    const bool good = elements.read([&, i = i] {
      const std::string name = message_name(topic, i);
      pose = read_ros_pose(read_message(bag, topic, i), topic.type, name);
      if (!first) first = pose;
      if (without_slash(pose.child) == without_slash(first->child)) return;
      throw InputError(name + ": a pose of '" + pose.child + "', before of '" + first->child +
                       "'; expected those of one frame");
    });
    // Where it says that it is not known, nothing is interpolated either.
    poses.poses_.push_back({stamp, good ? pose.T : unknown_pose()});
  }
  elements.finish(notes);
  if (first) poses.body_ = without_slash(first->child);
  if (poses.body_.empty()) {
    notes.push_back(topic.name + ": poses of no named frame, taken as those of the sensor");
  } else if (!poses.tree_->connected(poses.body_, sensor)) {
    throw InputError(topic.name + ": poses of " + poses.body_ + ", but no transform leads to " +
                     (sensor.empty() ? "the sensor, whose frame is not named" : sensor) +
                     "; expected /tf_static or /tf to connect them");
  } else if (poses.body_ != without_slash(sensor)) {
    notes.push_back(topic.name + ": poses of " + poses.body_ + ", moved to " + sensor + " by TF");
  }
  return poses;
}

std::optional<Eigen::Isometry3d> BagPoses::at(double stamp) const {
  if (!fixed_.empty()) return tree_->find(fixed_, sensor_, stamp);
  const auto T = pose_at(poses_, stamp, kLongestGap);
  if (!T || body_.empty()) return T;
  const auto T_BS = tree_->find(body_, sensor_, stamp);
  if (!T_BS) return std::nullopt;
  return *T * *T_BS;
}

std::vector<double> BagPoses::stamps() const {
  std::vector<double> stamps;
  for (const TimedPose& pose : poses_) {
    if (is_known(pose.T)) stamps.push_back(pose.stamp);
  }
  return stamps;
}

std::optional<BagPoses> find_bag_poses(const BagFile& bag, const std::string& path,
                                       const BagPoseChoice& choice, const std::string& sensor,
                                       std::vector<std::string>& notes) {
  const BagTopic* given = given_topic(bag, path, choice.topics, "pose", is_pose_topic);
  if (given != nullptr && !choice.fixed_frame.empty()) {
    throw InputError(path + ": both a topic of poses, " + given->name + ", and a fixed frame, " +
                     choice.fixed_frame + ", are given; expected one");
  }
  const auto tree = read_transforms(bag, notes);
  if (given != nullptr) return BagPoses::of_topic(bag, *given, tree, sensor, notes);
  const auto by_frame = [&](const std::string& frame) {
    notes.push_back("poses by TF, from " + frame + " to " + sensor);
    return BagPoses::of_frame(tree, frame, sensor);
  };
  if (!choice.fixed_frame.empty()) {
    if (!tree->connected(choice.fixed_frame, sensor)) {
      throw InputError(path + ": no transform leads from " + choice.fixed_frame + " to " +
                       (sensor.empty() ? "the sensor, whose frame is not named" : sensor) +
                       "; expected a frame above it, such as " + tree->root(sensor));
    }
    return by_frame(choice.fixed_frame);
  }
  if (tree->moves("map", sensor)) return by_frame("map");
  const BagTopic* topic = nullptr;
  for (const BagTopic& one : bag.topics()) {
    if (is_pose_topic(one) && !one.messages.empty() &&
        (topic == nullptr || (one.type == "nav_msgs/msg/Odometry" && topic->type != one.type))) {
      topic = &one;
    }
  }
  if (topic != nullptr) {
    std::string others;
    for (const BagTopic& one : bag.topics()) {
      if (&one == topic || !is_pose_topic(one) || one.messages.empty()) continue;
      others += (others.empty() ? "; not used: " : ", ") + one.name;
    }
    notes.push_back("topic pose=" + topic->name + ", by its type" + others);
    return BagPoses::of_topic(bag, *topic, tree, sensor, notes);
  }
  for (const std::string& frame : {std::string("odom"), std::string("world"), tree->root(sensor)}) {
    if (tree->moves(frame, sensor)) return by_frame(frame);
  }
  return std::nullopt;
}

PosedStamps stamps_with_poses(const BagPoses& poses, const std::vector<double>& stamps,
                              const std::string& what, const std::string& topic,
                              const std::string& path, std::vector<std::string>& notes) {
  PosedStamps posed;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto T = poses.at(stamps[i]);
    if (!T) {
      ++posed.without;
      continue;
    }
    posed.order.push_back(i);
    posed.poses.push_back(*T);
  }
  if (posed.order.empty()) {
    throw InputError(path + ": no pose by " + poses.from() + " is at the time of any " + what +
                     " of " + topic + "; expected them together");
  }
  if (posed.without > 0) {
    notes.push_back(std::to_string(posed.without) + " " + what +
                    "s without a pose at their time left out");
  }
  return posed;
}

}  // namespace prospect
