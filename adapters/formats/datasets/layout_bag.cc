// Bags of ROS 2: images, their camera_info, poses and static transforms, by topic.

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_poses.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect {
namespace {

bool is_info(const BagTopic& topic) { return is_of_type(topic, ros::CameraInfo::kType); }

/// The images of a topic, by the stamps of their headers; where these are not set, by the time of
/// recording.
ImageStream image_stream(const BagFile& bag, const BagTopic& topic,
                         std::vector<std::string>& notes) {
  ImageStream stream;
  stream.name = topic.name;
  std::vector<std::size_t> order;
  for (const auto& [stamp, i] : stamped_messages(bag, topic, "images", notes)) {
    stream.stamps.push_back(stamp);
    stream.names.push_back(message_name(topic, i));
    order.push_back(i);
  }
  stream.read = [bag, &topic = *bag.find(topic.name), order](std::size_t i) {
    const std::string bytes = read_message(bag, topic, order.at(i));
    return read_ros_image(bytes, is_compressed(topic), message_name(topic, order[i]));
  };
  return stream;
}

/// What all messages of a topic say of the images.
CameraInfo only_info(const BagFile& bag, const BagTopic& topic, std::vector<std::string>& notes) {
  if (topic.messages.empty()) {
    throw InputError(topic.name + ": holds no message; expected a calibration");
  }
  Elements infos("calibrations of " + topic.name);
  std::optional<CameraInfo> first;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    CameraInfo info;
    if (!infos.read([&] {
          info = read_ros_camera_info(read_message(bag, topic, i), message_name(topic, i));
        })) {
      continue;
    }
    if (first && info != *first) {
      throw InputError(message_name(topic, i) +
                       ": another calibration than the first one's; expected one of all images, or "
                       "--calibration FILE");
    }
    first = info;
  }
  infos.finish(notes);
  return *first;
}

}  // namespace

StereoSource open_stereo_bag(const std::string& path, const StereoDatasetOptions& options) {
  StereoSource source;
  source.layout = "ROS 2 bag";
  const BagFile bag = BagFile::open(path);
  source.notes = bag.notes();
  const BagTopic* left = nullptr;
  const BagTopic* right = nullptr;
  const bool read = source.attempt([&] {
    check_encodings(bag, path);
    left = given_topic(bag, path, options.topics, "left", is_image_topic);
    right = given_topic(bag, path, options.topics, "right", is_image_topic);
    if (left == nullptr || right == nullptr) {
      if (left != nullptr || right != nullptr) {
        throw InputError("--topics names one of left and right; expected both");
      }
      const StereoTopics found = find_stereo_topics(bag);
      left = found.left;
      right = found.right;
      if (left == nullptr) {
        throw InputError(path +
                         ": no two image topics are named left and right or the like; expected "
                         "--topics left=TOPIC,right=TOPIC of: " +
                         topic_list(bag));
      }
      source.notes.push_back("topics left=" + left->name + ",right=" + right->name +
                             ", by their names" + found.others);
    }
    source.left = image_stream(bag, *left, source.notes);
    source.right = image_stream(bag, *right, source.notes);
  });
  if (!read) return source;
  Eigen::Isometry3d T_rectified = Eigen::Isometry3d::Identity();
  source.attempt([&] {
    if (!options.calibration.empty()) {
      source.calibration = read_stereo_calibration(options.calibration, options.rectified);
      return;
    }
    const BagTopic* infos[2] = {given_topic(bag, path, options.topics, "left_info", is_info),
                                given_topic(bag, path, options.topics, "right_info", is_info)};
    if (infos[0] == nullptr) infos[0] = info_of(bag, *left);
    if (infos[1] == nullptr) infos[1] = info_of(bag, *right);
    if (infos[0] == nullptr || infos[1] == nullptr) {
      throw InputError(path + ": no camera_info beside " +
                       (infos[0] == nullptr ? left : right)->name +
                       "; expected --topics left_info=TOPIC,right_info=TOPIC, or --calibration "
                       "FILE");
    }
    const bool rectified = options.rectified || is_named_rectified(left->name);
    const CameraInfo first = only_info(bag, *infos[0], source.notes);
    const CameraInfo second = only_info(bag, *infos[1], source.notes);
    source.calibration = calibration_of(first, second, infos[0]->name, infos[1]->name, rectified);
    if (rectified) T_rectified = rectified_axes(first);
    source.notes.push_back(std::string("images taken as ") +
                           (rectified ? "rectified, by P of " : "raw, by K, D, R and P of ") +
                           infos[0]->name + " and " + infos[1]->name);
  });
  source.attempt([&] {
    const BagTopic* truth = given_topic(bag, path, options.topics, "truth", is_pose_topic);
    if (truth == nullptr) {
      if (!options.fixed_frame) return;
      const std::optional<BagPoses> poses = find_bag_poses(
          bag, path, {options.topics, *options.fixed_frame}, frame_of(bag, *left), source.notes);
      if (!poses) return;
      for (const double stamp : source.left.stamps) {
        const auto T = poses->at(stamp);
        if (T) source.truth.push_back({stamp, *T * T_rectified});
      }
      return;
    }
    const BagPoses poses = BagPoses::of_topic(bag, *truth, read_transforms(bag, source.notes),
                                              frame_of(bag, *left), source.notes);
    for (const double stamp : poses.stamps()) {
      const auto T = poses.at(stamp);
      if (T) source.truth.push_back({stamp, *T * T_rectified});
    }
  });
  return source;
}

DepthSource open_depth_bag(const std::string& path, const DepthDatasetOptions& options) {
  DepthSource source;
  source.layout = "ROS 2 bag";
  const BagFile bag = BagFile::open(path);
  source.notes = bag.notes();
  source.attempt([&] {
    check_encodings(bag, path);
    const BagTopic* depth = given_topic(bag, path, options.topics, "depth", is_image_topic);
    if (depth == nullptr) {
      const FoundTopic found = find_depth_topic(bag);
      depth = found.topic;
      if (depth == nullptr) {
        throw InputError(path +
                         ": no image topic has depth in its name; expected --topics "
                         "depth=TOPIC of: " +
                         topic_list(bag));
      }
      source.notes.push_back("topic depth=" + depth->name + ", by its name" + found.others);
    }
    ImageStream images = image_stream(bag, *depth, source.notes);
    const BagTopic* info = given_topic(bag, path, options.topics, "depth_info", is_info);
    if (info == nullptr) info = info_of(bag, *depth);
    Eigen::Isometry3d T_rectified = Eigen::Isometry3d::Identity();
    if (info != nullptr && !options.camera && options.calibration.empty()) {
      const CameraInfo calibration = only_info(bag, *info, source.notes);
      const bool rectified = is_named_rectified(depth->name);
      source.camera = depth_camera_of(calibration, rectified, info->name, source.notes);
      source.camera_from = info->name;
      if (rectified) T_rectified = rectified_axes(calibration);
    }
    const std::optional<BagPoses> poses = find_bag_poses(
        bag, path, {options.topics, options.fixed_frame}, frame_of(bag, *depth), source.notes);
    if (!poses) {
      source.images = std::move(images);
      return;
    }
    PosedStamps posed =
        stamps_with_poses(*poses, images.stamps, "image", depth->name, path, source.notes);
    source.without_pose = posed.without;
    for (const Eigen::Isometry3d& T : posed.poses) source.poses.push_back(T * T_rectified);
    ImageStream kept;
    kept.name = images.name;
    for (const std::size_t i : posed.order) {
      kept.stamps.push_back(images.stamps[i]);
      kept.names.push_back(images.names[i]);
    }
    kept.read = [images, order = std::move(posed.order)](std::size_t i) {
      return images.read(order.at(i));
    };
    source.images = std::move(kept);
  });
  return source;
}

}  // namespace prospect
