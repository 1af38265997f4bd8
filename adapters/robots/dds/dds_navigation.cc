// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_navigation.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/nav2_msgs.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/robots/dds/dds_commands.h"
#include "adapters/robots/dds/dds_service.h"
#include "engine/maps/belief.h"
#include "engine/maps/correction.h"

namespace prospect {
namespace {

using Status = ros::GoalStatus;

bool is_over(std::int8_t status) { return status >= Status::kSucceeded; }

}  // namespace

struct DdsNavigation::Impl {
  struct Served {
    ros::GoalInfo info;
    int number = 0;  // of the place
    Eigen::Vector2d place;
    double since = 0.0;  // [s] that it was taken
    std::int8_t status = Status::kAccepted;
    std::string why;
    std::vector<ServiceReply<ros::NavigateToPoseGetResultResponse>> asked;  // for its result
  };

  Impl(const DdsOptions& given, DdsNode& its_node, const DdsTransforms& its_transforms,
       const DdsBase& its_base, const Clock& its_clock, DriveRequests& its_requests)
      : options(given),
        node(its_node),
        transforms(its_transforms),
        base(its_base),
        clock(its_clock),
        requests(its_requests) {}

  bool take(const ros::NavigateToPoseSendGoalRequest& request, ros::Time& stamp) {
    const std::string& name = options.action;
    ros::FloorGoal goal;
    try {
      goal = goal_in_map(request.goal.pose, options.frames, transforms, name);
    } catch (const InputError& error) {
      requests.refuse(error.what());
      return false;
    }
    const std::lock_guard lock(mutex);
    std::string refused;
    Served served;
    if (over) {
      refused = "the mission is over";
    } else if (!request.goal.behavior_tree.empty()) {
      refused = "a behaviour tree; expected none";
    } else if (find(request.goal_id)) {
      refused = "a goal of the same number as another; expected a new one";
    } else {
      refused = DriveCommands(requests).go(goal.place, goal.yaw, &served.number);
    }
    if (!refused.empty()) {
      requests.refuse(name + ": " + refused);
      return false;
    }
    served.since = clock.now();
    stamp = base.ros_time(served.since);
    served.info = {request.goal_id, stamp};
    served.place = goal.place;
    if (goals.size() == kMost) goals.pop_front();
    goals.push_back(std::move(served));
    update();
    publish_status();
    return true;
  }

  ros::CancelGoalResponse cancel(const ros::GoalInfo& which) {
    const std::lock_guard lock(mutex);
    const double until = ros::seconds(which.stamp);
    const bool of_id = which.goal_id != ros::Uuid();
    ros::CancelGoalResponse response;
    for (Served& goal : goals) {
      const bool meant = (!of_id && until == 0.0) || goal.info.goal_id == which.goal_id ||
                         (until != 0.0 && ros::seconds(goal.info.stamp) <= until);
      if (!meant || is_over(goal.status)) continue;
      if (requests.detour().number != goal.number || !requests.cancel()) continue;
      goal.status = Status::kCanceling;
      response.goals_canceling.push_back(goal.info);
    }
    if (response.goals_canceling.empty()) {
      const Served* known = find(which.goal_id);
      response.return_code = known && is_over(known->status) ? ros::CancelGoalResponse::kTerminated
                             : of_id && !known               ? ros::CancelGoalResponse::kUnknownGoal
                                                             : ros::CancelGoalResponse::kRejected;
    }
    publish_status();
    return response;
  }

  void ask(const ros::Uuid& id, ServiceReply<ros::NavigateToPoseGetResultResponse> reply) {
    const std::lock_guard lock(mutex);
    Served* goal = find(id);
    if (!goal) return reply({});
    constexpr std::size_t kMostAsked = 10;
    if (goal->asked.size() < kMostAsked) goal->asked.push_back(std::move(reply));
    answer(*goal);
  }

  /// What has become of the goals since.
  void update() {
    bool changed = false;
    for (Served& goal : goals) {
      if (is_over(goal.status)) continue;
      const Detour detour = requests.detour(goal.number);
      const std::int8_t status = next(detour.state, goal.status);
      if (status == goal.status) continue;
      goal.status = status;
      goal.why = detour.why;
      changed = true;
      answer(goal);
    }
    if (changed) publish_status();
  }
  std::int8_t next(DetourState state, std::int8_t status) const {
    switch (state) {
      case DetourState::kThere:
        return Status::kSucceeded;
      case DetourState::kCancelled:
        return Status::kCanceled;
      case DetourState::kOnTheWay:
        if (over) return Status::kAborted;
        return status == Status::kCanceling ? status : Status::kExecuting;
      case DetourState::kAsked:
        return over ? Status::kAborted : status;
      default:
        return Status::kAborted;
    }
  }
  static void answer(Served& goal) {
    if (!is_over(goal.status)) return;
    ros::NavigateToPoseGetResultResponse response{goal.status, {}};
    if (goal.status == Status::kAborted) {
      response.result = {ros::NavigateToPoseResult::kUnknown, goal.why};
    }
    for (const auto& reply : std::exchange(goal.asked, {})) reply(response);
  }
  void publish_status() {
    ros::GoalStatusArray all;
    for (const Served& goal : goals) all.status_list.push_back({goal.info, goal.status});
    node.publish(statuses, all);
  }

  void publish_feedback(const Belief& belief) {
    constexpr double kEvery = 0.5;  // [s]
    const double now = clock.now();
    if (goals.empty() || goals.back().status != Status::kExecuting || now - told < kEvery) return;
    told = now;
    const Served& goal = goals.back();
    ros::NavigateToPoseFeedbackMessage m;
    m.goal_id = goal.info.goal_id;
    m.feedback.current_pose.header = {base.ros_time(belief.stamp), options.frames.map};
    const Pose pose = belief.map_frame ? belief.map_frame->to_map(belief.pose) : belief.pose;
    m.feedback.current_pose.pose = ros::pose_message(pose);
    const ros::Time taken = ros::time_of(now - goal.since);
    m.feedback.navigation_time = {taken.sec, taken.nanosec};
    m.feedback.distance_remaining =
        static_cast<float>((goal.place - pose.position.head<2>()).norm());
    node.publish(feedback, m);
  }

  Served* find(const ros::Uuid& id) {
    const auto its = std::find_if(goals.begin(), goals.end(),
                                  [&](const Served& goal) { return goal.info.goal_id == id; });
    return its == goals.end() ? nullptr : &*its;
  }

  static constexpr std::size_t kMost = 20;
  const DdsOptions options;
  DdsNode& node;
  const DdsTransforms& transforms;
  const DdsBase& base;
  const Clock& clock;
  DriveRequests& requests;
  int feedback = -1, statuses = -1;
  std::mutex mutex;
  std::deque<Served> goals;  // the newest last: only that may be under way
  double told = -1e9;        // [s] of the newest feedback
  bool over = false;
};

DdsNavigation::DdsNavigation(const DdsOptions& options, DdsNode& node,
                             const DdsTransforms& transforms, const DdsBase& base,
                             const Clock& clock, DriveRequests& requests)
    : impl_(std::make_shared<Impl>(options, node, transforms, base, clock, requests)) {
  if (options.action.empty()) return;
  const auto impl = impl_;
  const std::string name = options.action + "/_action/";
  impl->feedback =
      node.advertise<ros::NavigateToPoseFeedbackMessage>(name + "feedback", kReliableQos);
  impl->statuses = node.advertise<ros::GoalStatusArray>(name + "status", kLatchedQos);
  serve<ros::NavigateToPoseSendGoalRequest, ros::NavigateToPoseSendGoalResponse>(
      node, name + "send_goal", [impl](const auto& request, const auto& reply) {
        ros::NavigateToPoseSendGoalResponse response;
        response.accepted = impl->take(request, response.stamp);
        reply(response);
      });
  serve<ros::CancelGoalRequest, ros::CancelGoalResponse>(
      node, name + "cancel_goal",
      [impl](const auto& request, const auto& reply) { reply(impl->cancel(request.goal_info)); });
  serve<ros::NavigateToPoseGetResultRequest, ros::NavigateToPoseGetResultResponse>(
      node, name + "get_result",
      [impl](const auto& request, const auto& reply) { impl->ask(request.goal_id, reply); });
}
DdsNavigation::~DdsNavigation() = default;

void DdsNavigation::on_belief(const Belief& belief) {
  const std::lock_guard lock(impl_->mutex);
  impl_->update();
  impl_->publish_feedback(belief);
}

void DdsNavigation::on_end(const MissionResult&) {
  const std::lock_guard lock(impl_->mutex);
  impl_->over = true;
  impl_->update();
}

}  // namespace prospect
