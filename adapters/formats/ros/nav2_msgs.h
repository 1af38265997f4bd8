// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "adapters/formats/ros/action_msgs.h"
#include "adapters/formats/ros/geometry_msgs.h"

namespace prospect::ros {

// nav2_msgs/action/NavigateToPose as since Lyrical. Result and feedback of Humble, Jazzy and Kilted
// are the beginning of these bytes.

struct NavigateToPoseGoal {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_Goal";
  PoseStamped pose;
  std::string behavior_tree;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("pose", m.pose);
    visit("behavior_tree", m.behavior_tree);
  }
};

struct NavigateToPoseResult {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_Result";
  static constexpr std::uint16_t kUnknown = 9000;
  std::uint16_t error_code = 0;
  std::string error_msg;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("error_code", m.error_code);
    visit("error_msg", m.error_msg);
  }
};

struct NavigateToPoseFeedback {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_Feedback";
  PoseStamped current_pose;
  Duration navigation_time, estimated_time_remaining;
  std::int16_t number_of_recoveries = 0;
  float distance_remaining = 0.0F, position_tracking_error = 0.0F, heading_tracking_error = 0.0F;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("current_pose", m.current_pose);
    visit("navigation_time", m.navigation_time);
    visit("estimated_time_remaining", m.estimated_time_remaining);
    visit("number_of_recoveries", m.number_of_recoveries);
    visit("distance_remaining", m.distance_remaining);
    visit("position_tracking_error", m.position_tracking_error);
    visit("heading_tracking_error", m.heading_tracking_error);
  }
};

struct NavigateToPoseSendGoalRequest {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_SendGoal_Request";
  Uuid goal_id;
  NavigateToPoseGoal goal;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_id", m.goal_id);
    visit("goal", m.goal);
  }
};

struct NavigateToPoseSendGoalResponse {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_SendGoal_Response";
  bool accepted = false;
  Time stamp;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("accepted", m.accepted);
    visit("stamp", m.stamp);
  }
};

struct NavigateToPoseGetResultRequest {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_GetResult_Request";
  Uuid goal_id;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_id", m.goal_id);
  }
};

struct NavigateToPoseGetResultResponse {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_GetResult_Response";
  std::int8_t status = GoalStatus::kUnknown;
  NavigateToPoseResult result;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("status", m.status);
    visit("result", m.result);
  }
};

struct NavigateToPoseFeedbackMessage {
  static constexpr const char* kType = "nav2_msgs/action/NavigateToPose_FeedbackMessage";
  Uuid goal_id;
  NavigateToPoseFeedback feedback;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_id", m.goal_id);
    visit("feedback", m.feedback);
  }
};

}  // namespace prospect::ros
