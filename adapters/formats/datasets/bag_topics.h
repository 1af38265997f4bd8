// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adapters/formats/bags/bag_file.h"

namespace prospect {

// Topics of a bag of ROS 2 and their messages, for what reads recordings from it.

using TopicChoice = std::map<std::string, std::string>;  ///< of a use, such as "depth", the topic

/// Every topic with type and number of messages, and their encoding if it is not ROS 2's, for
/// messages to people.
std::string topic_list(const BagFile& bag);

/// Throws InputError, one line, if no topic of the bag is in CDR, ROS 2's encoding: such as logs of
/// Foxglove's own schemas in protobuf or JSON, and of ROS 1 in MCAP.
void check_encodings(const BagFile& bag, const std::string& path);

/// Whether its messages are of this type, in CDR.
bool is_of_type(const BagTopic& topic, std::string_view type);

/// The topic that was chosen for a use; null if none was. Throws InputError where it is absent, of
/// another type, or holds no message.
const BagTopic* given_topic(const BagFile& bag, const std::string& path, const TopicChoice& chosen,
                            const std::string& use, bool (*fits)(const BagTopic&));

/// Whether read_ros_pose() reads it.
bool is_pose_topic(const BagTopic& topic);

bool is_image_topic(const BagTopic& topic);  ///< of Image or CompressedImage
bool is_compressed(const BagTopic& topic);   ///< of CompressedImage
bool is_laser_scan(const BagTopic& topic);   ///< of LaserScan
bool is_scan_topic(const BagTopic& topic);   ///< of LaserScan or PointCloud2

/// "/stereo/left/image_rect/compressed" to "/stereo/left/camera_info"; null if it is not there.
const BagTopic* info_of(const BagFile& bag, const BagTopic& image);
/// A topic that was found by its name or type.
struct FoundTopic {
  const BagTopic* topic = nullptr;
  std::string others;  ///< that could have been meant, too, for messages: "; not used: /b, /c"
};
/// The topic of images with depth in its name, with a camera_info and not compressed before others;
/// null: none has images.
FoundTopic find_depth_topic(const BagFile& bag);
/// The topics of a stereo pair.
struct StereoTopics {
  const BagTopic* left = nullptr;
  const BagTopic* right = nullptr;
  std::string others;  ///< pairs that could have been meant, too, as FoundTopic
};
/// Image topics whose names differ by left and right, or the like, alone: rectified ones, those
/// with a camera_info and not compressed before others; null: none has images.
StereoTopics find_stereo_topics(const BagFile& bag);

/// A message, for messages to people.
std::string message_name(const BagTopic& topic, std::size_t i);

/// The bytes of message i; one that its recorder has compressed (mode MESSAGE, by zstd or lz4) is
/// decompressed. Throws InputError if they are not CDR.
std::string read_message(const BagFile& bag, const BagTopic& topic, std::size_t i);

/// The frame of the first message with a header; empty if there is none.
std::string frame_of(const BagFile& bag, const BagTopic& topic);

/// The stamps [s] of the headers, increasing, each with its message; where one is not set, the time
/// of recording. Those of another frame than the first one's are left out and counted (elements.h).
/// `notes` say how many of `what`, "images", had no stamp, one before that of the message before,
/// and how many are left out for the stamp of another.
std::vector<std::pair<double, std::size_t>> stamped_messages(const BagFile& bag,
                                                             const BagTopic& topic,
                                                             const std::string& what,
                                                             std::vector<std::string>& notes);

}  // namespace prospect
