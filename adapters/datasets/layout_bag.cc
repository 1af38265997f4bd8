// Bags of ROS 2: images, their camera_info, poses and static transforms, by topic.

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "adapters/datasets/bag_file.h"
#include "adapters/datasets/depth_source.h"
#include "adapters/datasets/number_text.h"
#include "adapters/datasets/ros_messages.h"
#include "adapters/datasets/stereo_source.h"
#include "adapters/datasets/trajectory_error.h"

namespace prospect {
namespace {

using TopicChoice = std::map<std::string, std::string>;

bool is_image_topic(const BagTopic& topic) {
  return topic.type == "sensor_msgs/msg/Image" || topic.type == "sensor_msgs/msg/CompressedImage";
}

bool is_compressed(const BagTopic& topic) {
  return topic.type == "sensor_msgs/msg/CompressedImage";
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string topic_list(const BagFile& bag) {
  std::string list;
  for (const BagTopic& topic : bag.topics()) {
    list += (list.empty() ? "" : ", ") + topic.name + " (" + topic.type + ", " +
            std::to_string(topic.messages.size()) + ")";
  }
  return list;
}

/// The topic that was given for a use; null if none was. Throws InputError where it is absent or of
/// another type.
const BagTopic* given_topic(const BagFile& bag, const std::string& path, const TopicChoice& chosen,
                            const std::string& use, bool (*fits)(const BagTopic&)) {
  const auto found = chosen.find(use);
  if (found == chosen.end()) return nullptr;
  const BagTopic* topic = bag.find(found->second);
  if (topic == nullptr) {
    throw InputError(path + ": has no topic " + found->second +
                     "; expected one of: " + topic_list(bag));
  }
  if (!fits(*topic)) {
    throw InputError(path + ": topic " + topic->name + " is of type " + topic->type +
                     "; expected one that can be " + use);
  }
  return topic;
}

bool is_info(const BagTopic& topic) { return topic.type == "sensor_msgs/msg/CameraInfo"; }
bool is_pose(const BagTopic& topic) { return is_ros_pose(topic.type); }

/// "/stereo/left/image_rect/compressed" to "/stereo/left/camera_info"; null if it is not there.
const BagTopic* info_of(const BagFile& bag, const BagTopic& image) {
  std::string name = image.name;
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    if (name.ends_with(transport)) name.resize(name.size() - std::string(transport).size());
  }
  const BagTopic* info = bag.find(name.substr(0, name.rfind('/')) + "/camera_info");
  return info != nullptr && is_info(*info) ? info : nullptr;
}

std::string message_name(const BagTopic& topic, std::size_t i) {
  return topic.name + " message " + std::to_string(i);
}

std::string read_message(const BagFile& bag, const BagTopic& topic, std::size_t i) {
  if (topic.encoding != "cdr") {
    throw InputError(topic.name + ": messages in '" + topic.encoding + "'; expected cdr, of ROS 2");
  }
  return bag.read(topic.messages[i]);
}

/// The images of a topic, by the stamps of their headers; where these are not set, by the time of
/// recording.
ImageStream image_stream(const BagFile& bag, const BagTopic& topic,
                         std::vector<std::string>& notes) {
  ImageStream stream;
  stream.name = topic.name;
  std::vector<std::size_t> order;
  int unset = 0, repeated = 0;
  std::vector<std::pair<double, std::size_t>> stamped;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    double stamp = read_ros_header(read_message(bag, topic, i), message_name(topic, i)).stamp;
    if (stamp <= 0.0) {
      stamp = static_cast<double>(topic.messages[i].time) * 1e-9;
      ++unset;
    }
    stamped.emplace_back(stamp, i);
  }
  std::stable_sort(stamped.begin(), stamped.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [stamp, i] : stamped) {
    if (!stream.stamps.empty() && !(stamp > stream.stamps.back())) {
      ++repeated;
      continue;
    }
    stream.stamps.push_back(stamp);
    stream.names.push_back(message_name(topic, i));
    order.push_back(i);
  }
  if (unset > 0) {
    notes.push_back(topic.name + ": " + std::to_string(unset) +
                    " images without a stamp: the time of recording stands for it");
  }
  if (repeated > 0) {
    notes.push_back(topic.name + ": " + std::to_string(repeated) +
                    " images with the stamp of another left out");
  }
  stream.read = [bag, &topic = *bag.find(topic.name), order](std::size_t i) {
    const std::string bytes = read_message(bag, topic, order.at(i));
    return read_ros_image(bytes, is_compressed(topic), message_name(topic, order[i]));
  };
  return stream;
}

/// Static transforms of a bag.
class StaticFrames {
 public:
  explicit StaticFrames(const BagFile& bag) {
    const BagTopic* topic = bag.find("/tf_static");
    if (topic == nullptr || topic->type != "tf2_msgs/msg/TFMessage") return;
    for (std::size_t i = 0; i < topic->messages.size(); ++i) {
      for (const RosTransform& t :
           read_ros_transforms(read_message(bag, *topic, i), message_name(*topic, i))) {
        parents_[plain(t.child)] = {plain(t.parent), t.T};
      }
    }
  }

  /// `from` to `to`; none if they are not connected.
  std::optional<Eigen::Isometry3d> find(const std::string& to, const std::string& from) const {
    const auto [root_a, T_a] = to_root(plain(to));
    const auto [root_b, T_b] = to_root(plain(from));
    if (root_a != root_b) return std::nullopt;
    return T_a.inverse() * T_b;
  }

 private:
  static std::string plain(const std::string& frame) {
    return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
  }
  std::pair<std::string, Eigen::Isometry3d> to_root(std::string frame) const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (std::size_t steps = 0; steps <= parents_.size(); ++steps) {
      const auto parent = parents_.find(frame);
      if (parent == parents_.end()) break;
      T = parent->second.second * T;
      frame = parent->second.first;
    }
    return {frame, T};
  }
  std::map<std::string, std::pair<std::string, Eigen::Isometry3d>> parents_;
};

/// The poses of a topic, moved to the frame of a camera.
Trajectory camera_poses(const BagFile& bag, const BagTopic& topic, const std::string& camera,
                        std::vector<std::string>& notes) {
  const StaticFrames frames(bag);
  Trajectory out;
  std::string body;
  std::optional<Eigen::Isometry3d> T_BC;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    const RosTransform pose =
        read_ros_pose(read_message(bag, topic, i), topic.type, message_name(topic, i));
    if (i == 0) {
      body = pose.child;
      T_BC =
          body.empty() ? std::optional(Eigen::Isometry3d::Identity()) : frames.find(body, camera);
      if (!T_BC) {
        throw InputError(topic.name + ": poses of " + body + ", but no static transform leads to " +
                         camera + "; expected /tf_static to connect them");
      }
      if (body.empty()) {
        notes.push_back(topic.name + ": poses of no named frame, taken as those of the camera");
      } else if (body != camera) {
        notes.push_back(topic.name + ": poses of " + body + ", moved to " + camera +
                        " by /tf_static");
      }
    }
    if (!out.empty() && !(pose.stamp > out.back().stamp)) continue;
    out.push_back({pose.stamp, pose.T * *T_BC});
  }
  return out;
}

std::string frame_of(const BagFile& bag, const BagTopic& topic) {
  return topic.messages.empty()
             ? std::string()
             : read_ros_header(read_message(bag, topic, 0), message_name(topic, 0)).frame;
}

/// Image topics whose names differ by left and right alone; rectified ones first.
std::pair<const BagTopic*, const BagTopic*> find_stereo_topics(const BagFile& bag) {
  static const std::pair<const char*, const char*> kSides[] = {{"left", "right"},
                                                               {"infra1", "infra2"},
                                                               {"cam0", "cam1"},
                                                               {"camera0", "camera1"},
                                                               {"image_0", "image_1"}};
  std::pair<const BagTopic*, const BagTopic*> best{nullptr, nullptr};
  int best_rank = -1;
  for (const BagTopic& topic : bag.topics()) {
    if (!is_image_topic(topic) || topic.messages.empty() || holds(topic.name, "depth")) continue;
    for (const auto& [left, right] : kSides) {
      std::string name = topic.name;
      if (!holds(name, left)) continue;
      for (std::size_t at = 0; (at = name.find(left, at)) != std::string::npos;) {
        name.replace(at, std::string(left).size(), right);
        at += std::string(right).size();
      }
      const BagTopic* other = bag.find(name);
      if (other == nullptr || !is_image_topic(*other) || other->messages.empty()) continue;
      const int rank =
          4 * holds(name, "rect") + 2 * (info_of(bag, topic) != nullptr) + !is_compressed(topic);
      if (rank > best_rank) {
        best_rank = rank;
        best = {&topic, other};
      }
    }
  }
  return best;
}

const BagTopic* find_depth_topic(const BagFile& bag) {
  const BagTopic* best = nullptr;
  int best_rank = -1;
  for (const BagTopic& topic : bag.topics()) {
    if (!is_image_topic(topic) || topic.messages.empty() || !holds(topic.name, "depth")) continue;
    const int rank = 2 * (info_of(bag, topic) != nullptr) + !is_compressed(topic);
    if (rank > best_rank) {
      best_rank = rank;
      best = &topic;
    }
  }
  return best;
}

CameraInfo first_info(const BagFile& bag, const BagTopic& topic) {
  if (topic.messages.empty()) {
    throw InputError(topic.name + ": holds no message; expected a calibration");
  }
  return read_ros_camera_info(read_message(bag, topic, 0), message_name(topic, 0));
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
    left = given_topic(bag, path, options.topics, "left", is_image_topic);
    right = given_topic(bag, path, options.topics, "right", is_image_topic);
    if (left == nullptr || right == nullptr) {
      if (left != nullptr || right != nullptr) {
        throw InputError("--topics names one of left and right; expected both");
      }
      std::tie(left, right) = find_stereo_topics(bag);
      if (left == nullptr) {
        throw InputError(path +
                         ": no two image topics are named left and right or the like; expected "
                         "--topics left=TOPIC,right=TOPIC of: " +
                         topic_list(bag));
      }
      source.notes.push_back("topics left=" + left->name + ",right=" + right->name +
                             ", by their names");
    }
    source.left = image_stream(bag, *left, source.notes);
    source.right = image_stream(bag, *right, source.notes);
  });
  if (!read) return source;
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
    const bool rectified = options.rectified || holds(left->name, "rect");
    source.calibration = calibration_of(first_info(bag, *infos[0]), first_info(bag, *infos[1]),
                                        infos[0]->name, infos[1]->name, rectified);
    source.notes.push_back(std::string("images taken as ") +
                           (rectified ? "rectified, by P of " : "raw, by K, D, R and P of ") +
                           infos[0]->name + " and " + infos[1]->name);
  });
  source.attempt([&] {
    const BagTopic* truth = given_topic(bag, path, options.topics, "truth", is_pose);
    if (truth != nullptr) {
      source.truth = camera_poses(bag, *truth, frame_of(bag, *left), source.notes);
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
    const BagTopic* depth = given_topic(bag, path, options.topics, "depth", is_image_topic);
    if (depth == nullptr) {
      depth = find_depth_topic(bag);
      if (depth == nullptr) {
        throw InputError(path +
                         ": no image topic has depth in its name; expected --topics "
                         "depth=TOPIC of: " +
                         topic_list(bag));
      }
      source.notes.push_back("topic depth=" + depth->name + ", by its name");
    }
    ImageStream images = image_stream(bag, *depth, source.notes);
    const BagTopic* info = given_topic(bag, path, options.topics, "depth_info", is_info);
    if (info == nullptr) info = info_of(bag, *depth);
    if (info != nullptr) {
      const CameraInfo calibration = first_info(bag, *info);
      const auto& K = calibration.K;
      if (!(K[0] > 0.0 && K[4] > 0.0)) {
        throw InputError(info->name + ": K is not that of a camera; expected intrinsics");
      }
      source.camera = PinholeCamera{K[0], K[4], K[2], K[5], calibration.width, calibration.height};
      source.camera_from = info->name;
    }
    const BagTopic* pose = given_topic(bag, path, options.topics, "pose", is_pose);
    if (pose == nullptr) {
      for (const BagTopic& topic : bag.topics()) {
        if (is_pose(topic) && !topic.messages.empty() &&
            (pose == nullptr || topic.type == "nav_msgs/msg/Odometry")) {
          pose = &topic;
        }
      }
      if (pose != nullptr) source.notes.push_back("topic pose=" + pose->name + ", by its type");
    }
    if (pose == nullptr) {
      source.images = std::move(images);
      return;
    }
    const Trajectory poses = camera_poses(bag, *pose, frame_of(bag, *depth), source.notes);
    ImageStream kept;
    kept.name = images.name;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const auto pairs = associate({{images.stamps[i], Eigen::Isometry3d::Identity()}}, poses);
      if (pairs.empty()) {
        ++source.without_pose;
        continue;
      }
      source.poses.push_back(pairs[0].truth);
      kept.stamps.push_back(images.stamps[i]);
      kept.names.push_back(images.names[i]);
      order.push_back(i);
    }
    if (order.empty()) {
      throw InputError(path + ": no pose of " + pose->name + " is at the time of an image of " +
                       depth->name + "; expected them together");
    }
    if (source.without_pose > 0) {
      source.notes.push_back(std::to_string(source.without_pose) +
                             " images without a pose at their time left out");
    }
    kept.read = [images, order](std::size_t i) { return images.read(order.at(i)); };
    source.images = std::move(kept);
  });
  return source;
}

}  // namespace prospect
