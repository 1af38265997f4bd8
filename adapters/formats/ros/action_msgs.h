// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct Uuid {
  static constexpr const char* kType = "unique_identifier_msgs/msg/UUID";
  std::array<std::uint8_t, 16> uuid{};

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("uuid", m.uuid);
  }
  bool operator==(const Uuid&) const = default;
};

struct GoalInfo {
  static constexpr const char* kType = "action_msgs/msg/GoalInfo";
  Uuid goal_id;
  Time stamp;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_id", m.goal_id);
    visit("stamp", m.stamp);
  }
};

struct GoalStatus {
  static constexpr const char* kType = "action_msgs/msg/GoalStatus";
  static constexpr std::int8_t kUnknown = 0, kAccepted = 1, kExecuting = 2, kCanceling = 3,
                               kSucceeded = 4, kCanceled = 5, kAborted = 6;
  GoalInfo goal_info;
  std::int8_t status = kUnknown;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_info", m.goal_info);
    visit("status", m.status);
  }
};

struct GoalStatusArray {
  static constexpr const char* kType = "action_msgs/msg/GoalStatusArray";
  std::vector<GoalStatus> status_list;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("status_list", m.status_list);
  }
};

struct CancelGoalRequest {
  static constexpr const char* kType = "action_msgs/srv/CancelGoal_Request";
  GoalInfo goal_info;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("goal_info", m.goal_info);
  }
};

struct CancelGoalResponse {
  static constexpr const char* kType = "action_msgs/srv/CancelGoal_Response";
  static constexpr std::int8_t kNone = 0, kRejected = 1, kUnknownGoal = 2, kTerminated = 3;
  std::int8_t return_code = kNone;
  std::vector<GoalInfo> goals_canceling;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("return_code", m.return_code);
    visit("goals_canceling", m.goals_canceling);
  }
};

}  // namespace prospect::ros
