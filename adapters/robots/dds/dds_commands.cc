// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_commands.h"

#include <algorithm>
#include <array>

#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/std_srvs.h"
#include "adapters/robots/dds/dds_service.h"

namespace prospect {
namespace {

constexpr std::array kWords = {"hold", "resume", "cancel", "stop"};

std::string told(DriveRequests& requests, const std::string& word) {
  if (std::find(kWords.begin(), kWords.end(), word) == kWords.end()) {
    return "'" + word + "': no command; expected hold, resume, cancel or stop";
  }
  return DriveCommands(requests).give(word);
}

}  // namespace

ros::FloorGoal goal_in_map(const ros::PoseStamped& pose, const DdsOptions::Frames& frames,
                           const DdsTransforms& transforms, const std::string& name) {
  const std::string frame = without_slash(pose.header.frame_id);
  if (frame.empty()) {
    throw InputError(name + ": a goal without a frame; expected one in '" + frames.map + "'");
  }
  Eigen::Isometry3d goal = ros::goal_transform(pose.pose, name);
  if (frame != frames.map) {
    const double stamp = ros::seconds(pose.header.stamp);
    const auto T = stamp == 0.0 ? transforms.newest(frames.map, frame)
                                : transforms.find(frames.map, frame, stamp);
    if (!T) {
      throw InputError(name + ": a goal in the frame '" + frame +
                       "', which tf does not connect with '" + frames.map +
                       "' at its stamp; expected one that it does");
    }
    goal = *T * goal;
  }
  return ros::floor_goal(goal, name);
}

DdsCommands::DdsCommands(const DdsOptions& options, DdsNode& node, const DdsTransforms& transforms,
                         DriveRequests& requests) {
  if (!options.goal.empty()) {
    const auto frames = options.frames;
    const std::string name = options.goal;
    node.subscribe<ros::PoseStamped>(
        name, kReliableQos, [&requests, &transforms, frames, name](const ros::PoseStamped& m) {
          try {
            const ros::FloorGoal goal = goal_in_map(m, frames, transforms, name);
            const std::string refused = DriveCommands(requests).go(goal.place, goal.yaw);
            if (!refused.empty()) requests.refuse(name + ": " + refused);
          } catch (const InputError& error) {
            requests.refuse(error.what());
          }
        });
  }
  if (!options.told.empty()) {
    const std::string name = options.told;
    node.subscribe<ros::String>(name, kReliableQos, [&requests, name](const ros::String& m) {
      const std::string refused = told(requests, m.data);
      if (!refused.empty()) requests.refuse(name + ": " + refused);
    });
  }
  if (options.services.empty()) return;
  for (const std::string word : kWords) {
    serve<ros::TriggerRequest, ros::TriggerResponse>(
        node, options.services + "/" + word,
        [&requests, word](const ros::TriggerRequest&,
                          const ServiceReply<ros::TriggerResponse>& reply) {
          const std::string refused = told(requests, word);
          reply({refused.empty(), refused});
        });
  }
}

}  // namespace prospect
