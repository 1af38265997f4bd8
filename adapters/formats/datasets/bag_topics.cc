// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/bag_topics.h"

#include <algorithm>
#include <optional>

#include "adapters/formats/bags/decompression.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/stereo_calibration.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect {
namespace {

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void add_other(const std::string& name, std::string& others) {
  others += (others.empty() ? "; not used: " : ", ") + name;
}

bool is_cdr(const BagTopic& topic) { return topic.encoding == "cdr"; }

constexpr std::size_t kLargestMessage = std::size_t{1} << 30;  // [bytes]

}  // namespace

std::string topic_list(const BagFile& bag) {
  std::string list;
  for (const BagTopic& topic : bag.topics()) {
    list += (list.empty() ? "" : ", ") + topic.name + " (" + topic.type +
            (is_cdr(topic) ? "" : " in " + topic.encoding) + ", " +
            std::to_string(topic.messages.size()) + ")";
  }
  return list;
}

void check_encodings(const BagFile& bag, const std::string& path) {
  const auto& topics = bag.topics();
  if (std::any_of(topics.begin(), topics.end(), is_cdr)) return;
  throw InputError(path +
                   ": no message is in cdr, ROS 2's encoding; expected a bag of ROS 2, not " +
                   topic_list(bag));
}

bool is_of_type(const BagTopic& topic, std::string_view type) {
  return is_cdr(topic) && topic.type == type;
}

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
                     (is_cdr(*topic) ? "" : " in " + topic->encoding + ", not cdr as of ROS 2") +
                     "; expected one that can be " + use);
  }
  if (topic->messages.empty()) {
    throw InputError(path + ": topic " + topic->name +
                     " holds no message; expected one of: " + topic_list(bag));
  }
  return topic;
}

bool is_pose_topic(const BagTopic& topic) { return is_cdr(topic) && is_ros_pose(topic.type); }

bool is_image_topic(const BagTopic& topic) {
  return is_of_type(topic, ros::Image::kType) || is_compressed(topic);
}

bool is_compressed(const BagTopic& topic) { return is_of_type(topic, ros::CompressedImage::kType); }

bool is_laser_scan(const BagTopic& topic) { return is_of_type(topic, ros::LaserScan::kType); }

bool is_scan_topic(const BagTopic& topic) {
  return is_laser_scan(topic) || is_of_type(topic, ros::PointCloud2::kType);
}

const BagTopic* info_of(const BagFile& bag, const BagTopic& image) {
  std::string name = image.name;
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    if (name.ends_with(transport)) name.resize(name.size() - std::string(transport).size());
  }
  const BagTopic* info = bag.find(name.substr(0, name.rfind('/')) + "/camera_info");
  return info != nullptr && is_of_type(*info, ros::CameraInfo::kType) ? info : nullptr;
}

FoundTopic find_depth_topic(const BagFile& bag) {
  FoundTopic best;
  int best_rank = -1;
  std::vector<const BagTopic*> all;
  for (const BagTopic& topic : bag.topics()) {
    if (!is_image_topic(topic) || topic.messages.empty() || !holds(topic.name, "depth")) continue;
    all.push_back(&topic);
    const int rank = 2 * (info_of(bag, topic) != nullptr) + !is_compressed(topic);
    if (rank > best_rank) {
      best_rank = rank;
      best.topic = &topic;
    }
  }
  for (const BagTopic* topic : all) {
    if (topic != best.topic) add_other(topic->name, best.others);
  }
  return best;
}

StereoTopics find_stereo_topics(const BagFile& bag) {
  static const std::pair<const char*, const char*> kSides[] = {{"left", "right"},
                                                               {"infra1", "infra2"},
                                                               {"cam0", "cam1"},
                                                               {"camera0", "camera1"},
                                                               {"image_0", "image_1"}};
  StereoTopics best;
  int best_rank = -1;
  std::vector<std::pair<const BagTopic*, const BagTopic*>> all;
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
      all.emplace_back(&topic, other);
      const int rank = 4 * is_named_rectified(name) + 2 * (info_of(bag, topic) != nullptr) +
                       !is_compressed(topic);
      if (rank > best_rank) {
        best_rank = rank;
        best.left = &topic;
        best.right = other;
      }
    }
  }
  for (const auto& [left, right] : all) {
    if (left == best.left) continue;
    add_other(left->name + " and " + right->name, best.others);
  }
  return best;
}

std::string message_name(const BagTopic& topic, std::size_t i) {
  return topic.name + " message " + std::to_string(i);
}

std::string read_message(const BagFile& bag, const BagTopic& topic, std::size_t i) {
  if (!is_cdr(topic)) {
    throw InputError(topic.name + ": messages in '" + topic.encoding + "'; expected cdr, of ROS 2");
  }
  std::string bytes = bag.read(topic.messages[i]);
  // CDR begins with a byte of zero, which no compressed message does.
  const Compression compression = compression_of(bytes);
  if (compression == Compression::kNone) return bytes;
  return decompressed(compression, bytes, kLargestMessage, message_name(topic, i));
}

std::string frame_of(const BagFile& bag, const BagTopic& topic) {
  Elements headers("");
  std::string frame;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    if (headers.read([&] {
          frame = read_ros_header(read_message(bag, topic, i), message_name(topic, i)).frame;
        })) {
      break;
    }
  }
  return frame;
}

std::vector<std::pair<double, std::size_t>> stamped_messages(const BagFile& bag,
                                                             const BagTopic& topic,
                                                             const std::string& what,
                                                             std::vector<std::string>& notes) {
  std::vector<std::pair<double, std::size_t>> stamped;
  std::size_t unset = 0;
  Elements headers(what + " of " + topic.name);
  std::optional<std::string> frame;
  for (std::size_t i = 0; i < topic.messages.size(); ++i) {
    double stamp = 0.0;
    if (!headers.read([&] {
          const RosHeader header =
              read_ros_header(read_message(bag, topic, i), message_name(topic, i));
          if (!frame) frame = header.frame;
          if (without_slash(header.frame) != without_slash(*frame)) {
            throw InputError(message_name(topic, i) + ": is of frame '" + header.frame +
                             "', before of '" + *frame + "'; expected those of one frame");
          }
          stamp = header.stamp;
        })) {
      continue;
    }
    if (stamp <= 0.0) {
      stamp = static_cast<double>(topic.messages[i].time) * 1e-9;
      ++unset;
    }
    stamped.emplace_back(stamp, i);
  }
  headers.finish(notes);
  if (unset > 0) {
    notes.push_back(topic.name + ": " + std::to_string(unset) + " " + what +
                    " without a stamp: the time of recording stands for it");
  }
  std::size_t back = 0;
  double farthest = 0.0;  // [s]
  for (std::size_t n = 1; n < stamped.size(); ++n) {
    const double by = stamped[n - 1].first - stamped[n].first;
    back += by > 0.0 ? 1 : 0;
    farthest = std::max(farthest, by);
  }
  if (back > 0) {
    notes.push_back(topic.name + ": " + std::to_string(back) + " " + what +
                    " stamped before what was recorded before, by up to " + number_text(farthest) +
                    " s: taken in the order of their stamps");
  }
  std::stable_sort(stamped.begin(), stamped.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto repeated =
      std::unique(stamped.begin(), stamped.end(),
                  [](const auto& a, const auto& b) { return a.first == b.first; });
  if (repeated != stamped.end()) {
    notes.push_back(topic.name + ": " + std::to_string(stamped.end() - repeated) + " " + what +
                    " with the stamp of another left out");
    stamped.erase(repeated, stamped.end());
  }
  return stamped;
}

}  // namespace prospect
