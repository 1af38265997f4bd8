// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/ros/nav2_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/robots/dds/dds_service.h"
#include "engine/maps/belief.h"
#include "runtime/mission.h"
#include "tests/adapters/dds_pair.h"
#include "tests/adapters/formats/altered_message.h"

namespace prospect::dds_navigation_test {
namespace {

using test::kPatience;
using test::within;
using Status = ros::GoalStatus;

/// One half of a service as its client has it: questions go out, answers come in.
template <typename Request, typename Response>
class Asks {
 public:
  Asks(DdsNode& node, const std::string& service) : node_(node) {
    topic_ = node.advertise(service, ros::definition_of<Request>(), kReliableQos,
                            DdsNode::Role::kRequests);
    node.subscribe(service, ros::definition_of<Response>(), kReliableQos,
                   DdsNode::PublisherHandler(
                       [this](std::string_view cdr, const std::string& name, std::uint64_t) {
                         const auto answer = ros::from_cdr<ServiceCall<Response>>(cdr, name);
                         const std::lock_guard lock(mutex_);
                         if (answer.number == number_) answer_ = answer.body;
                       }),
                   DdsNode::Role::kReplies);
  }
  void ask(const Request& request) {
    std::int64_t number = 0;
    {
      const std::lock_guard lock(mutex_);
      number = ++number_;
      answer_.reset();
    }
    node_.publish(topic_, ServiceCall<Request>{7, number, request});
  }
  std::optional<Response> answer() {
    const std::lock_guard lock(mutex_);
    return answer_;
  }

 private:
  DdsNode& node_;
  int topic_ = -1;
  std::mutex mutex_;
  std::int64_t number_ = 0;
  std::optional<Response> answer_;
};

/// A client of the action.
class Client {
 public:
  explicit Client(const std::string& action)
      : node_(test::dds_test_address("nav2")),
        send_(node_, action + "/_action/send_goal"),
        result_(node_, action + "/_action/get_result"),
        cancel_(node_, action + "/_action/cancel_goal") {
    node_.subscribe<ros::GoalStatusArray>(action + "/_action/status", kLatchedQos,
                                          [this](const ros::GoalStatusArray& m) {
                                            const std::lock_guard lock(mutex_);
                                            for (const Status& s : m.status_list) {
                                              statuses_[s.goal_info.goal_id.uuid[0]] = s.status;
                                            }
                                          });
    node_.subscribe<ros::NavigateToPoseFeedbackMessage>(
        action + "/_action/feedback", kReliableQos,
        [this](const ros::NavigateToPoseFeedbackMessage& m) {
          const std::lock_guard lock(mutex_);
          feedback_ = m;
        });
    node_.start();
    EXPECT_TRUE(
        within(kPatience, [&] { return node_.publishers(action + "/_action/status") > 0; }));
  }
  static ros::Uuid id(std::uint8_t n) {
    ros::Uuid uuid;
    uuid.uuid[0] = n;
    return uuid;
  }
  static ros::NavigateToPoseSendGoalRequest goal(std::uint8_t n, const std::string& frame) {
    ros::NavigateToPoseSendGoalRequest request;
    request.goal_id = id(n);
    request.goal.pose.header.frame_id = frame;
    request.goal.pose.pose.position.x = n;
    request.goal.pose.pose.orientation.w = 1.0;
    return request;
  }
  /// The server's answer to one question: a node that has just come may not be heard at once.
  template <typename Asking, typename Request>
  static auto answered(Asking& asking, const Request& request) {
    asking.ask(request);
    int looked = 0;
    EXPECT_TRUE(within(
        kPatience, [&] { return asking.answer().has_value(); },
        [&] {
          if (++looked % 200 == 0) asking.ask(request);
        }));
    return asking.answer().value_or(decltype(*asking.answer()){});
  }
  int status(std::uint8_t n) {
    const std::lock_guard lock(mutex_);
    return statuses_.contains(n) ? statuses_[n] : -1;
  }
  std::optional<ros::NavigateToPoseFeedbackMessage> feedback() {
    const std::lock_guard lock(mutex_);
    return feedback_;
  }

 private:
  std::mutex mutex_;
  std::map<std::uint8_t, int> statuses_;
  std::optional<ros::NavigateToPoseFeedbackMessage> feedback_;
  DdsNode node_;

 public:
  Asks<ros::NavigateToPoseSendGoalRequest, ros::NavigateToPoseSendGoalResponse> send_;
  Asks<ros::NavigateToPoseGetResultRequest, ros::NavigateToPoseGetResultResponse> result_;
  Asks<ros::CancelGoalRequest, ros::CancelGoalResponse> cancel_;
};

class DdsNavigationTest : public ::testing::Test {
 protected:
  explicit DdsNavigationTest(const DdsOptions& options = {})
      : options_(options),
        node_(test::dds_test_address("prospect")),
        transforms_(node_),
        base_(options_, node_, transforms_, clock_),
        navigation_(options_, node_, transforms_, base_, clock_, requests_) {
    node_.start();
  }
  ~DdsNavigationTest() override { node_.stop(); }
  /// The mission takes the place that was asked for.
  int take() {
    std::optional<DriveRequests::Place> place;
    EXPECT_TRUE(within(kPatience, [&] { return (place = requests_.take_place()).has_value(); }));
    if (!place) return 0;
    place_ = place->position;
    requests_.tell({place->number, DetourState::kOnTheWay, ""});
    navigation_.on_belief(Belief());
    return place->number;
  }
  bool comes(Client& client, std::uint8_t n, int status) {
    return within(kPatience, [&] { return client.status(n) == status; });
  }

  DdsOptions options_;
  SteadyClock clock_;
  DdsNode node_;
  DdsTransforms transforms_;
  DdsBase base_;
  DriveRequests requests_;
  DdsNavigation navigation_;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();
};

TEST_F(DdsNavigationTest, AGoalIsDrivenToAndItsResultTold) {
  Client client(options_.action);
  EXPECT_TRUE(Client::answered(client.send_, Client::goal(3, "map")).accepted);
  const int number = take();
  EXPECT_EQ(place_, Eigen::Vector2d(3.0, 0.0));
  EXPECT_TRUE(comes(client, 3, Status::kExecuting));
  EXPECT_TRUE(within(
      kPatience, [&] { return client.feedback().has_value(); },
      [&] { navigation_.on_belief(Belief()); }));
  EXPECT_EQ(client.feedback()->goal_id, Client::id(3));
  EXPECT_EQ(client.feedback()->feedback.distance_remaining, 3.0F);

  client.result_.ask({Client::id(3)});  // before it is there
  requests_.tell({number, DetourState::kThere, "It is there."});
  navigation_.on_belief(Belief());
  EXPECT_TRUE(comes(client, 3, Status::kSucceeded));
  EXPECT_EQ(
      Client::answered(client.result_, ros::NavigateToPoseGetResultRequest{Client::id(3)}).status,
      Status::kSucceeded);
}

TEST_F(DdsNavigationTest, WhatDoesNotGetThereIsToldWhy) {
  Client client(options_.action);
  EXPECT_FALSE(Client::answered(client.send_, Client::goal(1, "moon")).accepted);
  EXPECT_TRUE(requests_.told_refused());
  EXPECT_TRUE(Client::answered(client.send_, Client::goal(2, "map")).accepted);
  take();
  // A newer one, of whomever, takes its place.
  EXPECT_TRUE(Client::answered(client.send_, Client::goal(3, "map")).accepted);
  const int number = take();
  EXPECT_TRUE(comes(client, 2, Status::kAborted));
  requests_.tell({number, DetourState::kNotThere, "no way leads there"});
  navigation_.on_belief(Belief());
  const auto result =
      Client::answered(client.result_, ros::NavigateToPoseGetResultRequest{Client::id(3)});
  EXPECT_EQ(result.status, Status::kAborted);
  EXPECT_EQ(result.result.error_msg, "no way leads there");
  EXPECT_EQ(result.result.error_code, ros::NavigateToPoseResult::kUnknown);

  EXPECT_TRUE(Client::answered(client.send_, Client::goal(4, "map")).accepted);
  navigation_.on_end(MissionResult());
  EXPECT_TRUE(comes(client, 4, Status::kAborted));
  EXPECT_FALSE(Client::answered(client.send_, Client::goal(5, "map")).accepted);
}

TEST_F(DdsNavigationTest, AGoalCanBeCancelled) {
  Client client(options_.action);
  EXPECT_TRUE(Client::answered(client.send_, Client::goal(1, "map")).accepted);
  const int number = take();
  ros::CancelGoalRequest of_another;
  of_another.goal_info.goal_id = Client::id(9);
  EXPECT_EQ(Client::answered(client.cancel_, of_another).return_code,
            ros::CancelGoalResponse::kUnknownGoal);
  EXPECT_FALSE(requests_.take_cancellation());
  const auto cancelled = Client::answered(client.cancel_, ros::CancelGoalRequest{});
  ASSERT_EQ(cancelled.goals_canceling.size(), 1u);
  EXPECT_EQ(cancelled.goals_canceling[0].goal_id, Client::id(1));
  EXPECT_TRUE(comes(client, 1, Status::kCanceling));
  EXPECT_TRUE(requests_.take_cancellation());
  requests_.tell({number, DetourState::kCancelled, "cancelled"});
  navigation_.on_belief(Belief());
  EXPECT_TRUE(comes(client, 1, Status::kCanceled));
  EXPECT_FALSE(requests_.told_to_drive());
}

/// Times are those of a simulation, so that a nanosecond counts.
class DdsNavigationFields : public DdsNavigationTest {
 protected:
  static DdsOptions in_simulated_time() {
    DdsOptions o;
    o.use_sim_time = true;
    return o;
  }
  DdsNavigationFields() : DdsNavigationTest(in_simulated_time()) {}

  /// A goal of its own number, but for the first byte; true: it is taken.
  bool send(Client& client, ros::NavigateToPoseSendGoalRequest request) {
    request.goal_id.uuid.back() = ++number_;
    id_ = request.goal_id;
    const auto answer = Client::answered(client.send_, request);
    stamp_ = answer.stamp;
    return answer.accepted;
  }
  static std::string text_of(const ros::CancelGoalResponse& response) {
    std::string text = "code " + std::to_string(response.return_code);
    for (const ros::GoalInfo& goal : response.goals_canceling) {
      text += " " + std::to_string(goal.goal_id.uuid.front());
    }
    return text;
  }

  std::uint8_t number_ = 0;
  ros::Uuid id_;
  ros::Time stamp_;
};

TEST_F(DdsNavigationFields, AreWhatTheTablesSay) {
  Client client(options_.action);
  // A frame that is turned and tilted, known at one time.
  DdsNode other(test::dds_test_address("tf"));
  const int tf = other.advertise<ros::TFMessage>("/tf", kTransformQos);
  other.start();
  ros::TransformStamped tilted;
  tilted.header = {{5, 0}, "map"};
  tilted.child_frame_id = "tilted";
  tilted.transform.translation = {1.0, 2.0, 0.0};
  tilted.transform.rotation = {0.1, 0.3, 0.2, std::sqrt(1.0 - 0.14)};
  EXPECT_TRUE(within(
      kPatience, [&] { return transforms_.find("map", "tilted", 5.0).has_value(); },
      [&] { other.publish(tf, ros::TFMessage{{tilted}}); }));

  auto goal = Client::goal(3, "tilted");
  goal.goal.pose.header.stamp = {5, 0};
  goal.goal.pose.pose.position = {1.0, 2.0, 3.0};
  goal.goal.pose.pose.orientation = {0.0, 0.0, 0.6, 0.8};
  auto turned = goal;
  turned.goal.pose.pose.orientation = {0.1, 0.1, 0.7, 0.7};
  test::expect_fields_of<ros::NavigateToPoseSendGoalRequest>(
      {goal, turned}, [&](const auto& request) -> std::string {
        if (!send(client, request)) return "refused";
        const std::optional<DriveRequests::Place> place = requests_.take_place();
        if (!place) return "refused: no place";
        requests_.tell({place->number, DetourState::kOnTheWay, ""});
        const auto cancelled = Client::answered(client.cancel_, ros::CancelGoalRequest{{id_, {}}});
        std::ostringstream text;
        text.precision(17);
        text << place->position.transpose() << ' ' << place->yaw.value_or(-9.0) << ' '
             << text_of(cancelled);
        return text.str();
      });

  ASSERT_TRUE(send(client, Client::goal(1, "map")));
  const ros::Uuid known = id_;
  ASSERT_TRUE(send(client, Client::goal(2, "map")));  // which ends the first
  test::expect_fields_of<ros::NavigateToPoseGetResultRequest>({{known}}, [&](const auto& request) {
    return std::to_string(Client::answered(client.result_, request).status);
  });

  // By its number, or by a time just before it.
  ros::CancelGoalRequest by_number, by_time;
  by_number.goal_info.goal_id.uuid.front() = 7;
  by_time.goal_info.stamp = {1, 50};
  test::expect_fields_of<ros::CancelGoalRequest>(
      {by_number, by_time}, [&](const ros::CancelGoalRequest& asked) {
        do {
          EXPECT_TRUE(send(client, Client::goal(7, "map")));
        } while (stamp_.nanosec < 100);
        // Seconds, nanoseconds and the number as asked, from those of the goal on.
        ros::CancelGoalRequest request = asked;
        if (asked.goal_info.stamp.sec > 0) {
          request.goal_info.stamp.sec += stamp_.sec - 1;
          request.goal_info.stamp.nanosec += stamp_.nanosec - 100;
        }
        if (asked.goal_info.goal_id.uuid.front() != 0) {
          request.goal_info.goal_id.uuid.back() = id_.uuid.back();
        }
        return text_of(Client::answered(client.cancel_, request));
      });
  other.stop();
}

}  // namespace
}  // namespace prospect::dds_navigation_test
