// SPDX-License-Identifier: Apache-2.0
// Bags of ROS 2: images, their camera_info, poses and static transforms, by topic.

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/bag_poses.h"
#include "adapters/formats/datasets/bag_topics.h"
#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/stereo_source.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "models/robot_description.h"

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

/// A topic of depth images and what its camera_info says.
struct DepthTopic {
  const BagTopic* images = nullptr;
  std::optional<PinholeCamera> camera;
  std::string camera_from;
  Eigen::Isometry3d T_rectified = Eigen::Isometry3d::Identity();

  void read(const BagFile& bag, const BagTopic* info, std::vector<std::string>& notes) {
    if (info == nullptr) return;
    const CameraInfo calibration = only_info(bag, *info, notes);
    const bool rectified = is_named_rectified(images->name);
    camera = depth_camera_of(calibration, rectified, info->name, notes);
    camera_from = info->name;
    if (rectified) T_rectified = rectified_axes(calibration);
  }
};

/// Those of `stream` at these places.
ImageStream part_of(const ImageStream& stream, std::vector<std::size_t> order) {
  ImageStream kept;
  kept.name = stream.name;
  for (const std::size_t i : order) {
    kept.stamps.push_back(stream.stamps[i]);
    kept.names.push_back(stream.names[i]);
  }
  kept.read = [stream, order = std::move(order)](std::size_t i) {
    return stream.read(order.at(i));
  };
  return kept;
}

constexpr double kRigid = 0.02;  // [m] and [rad] that two cameras may move against each other

using NamedTopic = std::pair<std::string, const BagTopic*>;  // a use and what it is given

/// The images of another camera, at whose stamps the first one's place is known, too. Throws
/// InputError where its calibration or its place is not known, or it moves against the first.
MoreDepthImages more_of(const BagFile& bag, const std::string& path, const NamedTopic& given,
                        const DepthTopic& first, const BagPoses& first_poses,
                        const BagPoseChoice& choice, std::vector<std::string>& notes) {
  const auto& [use, images_of] = given;
  const BagTopic& topic = *images_of;
  DepthTopic depth{&topic, {}, {}};
  depth.read(bag, info_of(bag, topic), notes);
  if (!depth.camera) {
    throw InputError(path + ": no camera_info beside " + topic.name + ", given as " + use +
                     "; expected one");
  }
  const ImageStream images = image_stream(bag, topic, notes);
  const std::optional<BagPoses> poses =
      find_bag_poses(bag, path, choice, frame_of(bag, topic), notes);
  MoreDepthImages more;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; poses && i < images.size(); ++i) {
    const auto T_DF = first_poses.at(images.stamps[i]), T_DC = poses->at(images.stamps[i]);
    if (!T_DF || !T_DC) continue;
    const Eigen::Isometry3d T_DR = *T_DF * first.T_rectified;
    const Eigen::Isometry3d T_FC = T_DR.inverse() * *T_DC * depth.T_rectified;
    if (order.empty()) more.T_FC = T_FC;
    const Eigen::Isometry3d moved = more.T_FC.inverse() * T_FC;
    if (moved.translation().norm() > kRigid || Eigen::AngleAxisd(moved.linear()).angle() > kRigid) {
      throw InputError(images.names[i] + ": its camera has moved against that of " +
                       first.images->name + "; expected cameras of one rig");
    }
    more.poses.push_back(T_DR);
    order.push_back(i);
  }
  if (order.empty()) {
    throw InputError(topic.name + ": given as " + use + ", has no image whose place against " +
                     first.images->name + " is known; expected transforms to both");
  }
  more.images = part_of(images, std::move(order));
  more.camera = *depth.camera;
  more.camera_from = depth.camera_from;
  return more;
}

/// The topics of other depth cameras: those that are given as depth_1, depth_2, ..., or named so
/// beside the first (/camera/depth/image_rect, /camera/depth_1/image_rect).
std::vector<NamedTopic> more_depth_topics(const BagFile& bag, const std::string& path,
                                          const DepthDatasetOptions& options,
                                          const std::string& first) {
  std::vector<NamedTopic> all;
  const std::size_t at = first.find("/depth/");
  for (int n = 1; n < kMostDepthSensors; ++n) {
    const std::string use = "depth_" + std::to_string(n);
    const BagTopic* topic = given_topic(bag, path, options.topics, use, is_image_topic);
    if (topic == nullptr && at != std::string::npos) {
      topic = bag.find(first.substr(0, at + 1) + use + first.substr(at + 6));
      if (topic != nullptr && (!is_image_topic(*topic) || topic->messages.empty())) topic = nullptr;
    }
    if (topic != nullptr) all.emplace_back(use, topic);
  }
  return all;
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
    source.imu = read_bag_imu(bag, path, options.topics, frame_of(bag, *left), source.notes);
    const Eigen::Quaterniond R(Eigen::Matrix3d(T_rectified.linear().transpose()));
    for (ImuSample& sample : source.imu.samples) sample.R_BS = R * sample.R_BS;
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
    FoundTopic found;
    if (depth == nullptr) {
      found = find_depth_topic(bag);
      depth = found.topic;
      if (depth == nullptr) {
        throw InputError(path +
                         ": no image topic has depth in its name; expected --topics "
                         "depth=TOPIC of: " +
                         topic_list(bag));
      }
    }
    const auto more = more_depth_topics(bag, path, options, depth->name);
    if (found.topic != nullptr) {
      source.notes.push_back("topic depth=" + depth->name + ", by its name" +
                             (more.empty() ? found.others : ""));
    }
    ImageStream images = image_stream(bag, *depth, source.notes);
    const BagTopic* info = given_topic(bag, path, options.topics, "depth_info", is_info);
    if (info == nullptr) info = info_of(bag, *depth);
    DepthTopic first{depth, {}, {}};
    if (!options.camera && options.calibration.empty()) first.read(bag, info, source.notes);
    source.camera = first.camera;
    source.camera_from = first.camera_from;
    const std::optional<BagPoses> poses = find_bag_poses(
        bag, path, {options.topics, options.fixed_frame}, frame_of(bag, *depth), source.notes);
    if (!poses) {
      source.images = std::move(images);
      return;
    }
    PosedStamps posed =
        stamps_with_poses(*poses, images.stamps, "image", depth->name, path, source.notes);
    source.without_pose = posed.without;
    for (const Eigen::Isometry3d& T : posed.poses) source.poses.push_back(T * first.T_rectified);
    source.images = part_of(images, std::move(posed.order));
    for (const NamedTopic& given : more) {
      source.notes.push_back("topic " + given.first + "=" + given.second->name);
      std::vector<std::string> notes;
      source.more.push_back(
          more_of(bag, path, given, first, *poses, {options.topics, options.fixed_frame}, notes));
      for (std::string& note : notes) {
        const auto same = std::find(source.notes.begin(), source.notes.end(), note);
        if (same == source.notes.end()) source.notes.push_back(std::move(note));
      }
    }
  });
  return source;
}

}  // namespace prospect
