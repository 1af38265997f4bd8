// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/std_srvs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/robots/dds/dds_service.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_commands_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

/// A person's node: RViz, and calls of services.
class Person {
 public:
  explicit Person(const DdsOptions& options) : node_(test::dds_test_address("rviz")) {
    goal_ = node_.advertise<ros::PoseStamped>(options.goal, kReliableQos);
    told_ = node_.advertise<ros::String>(options.told, kReliableQos);
    transforms_ = node_.advertise<ros::TFMessage>("/tf_static", kStaticTransformQos);
    const std::string name = options.services + "/hold";
    asks_ = node_.advertise(name, ros::definition_of<ros::TriggerRequest>(), kReliableQos,
                            DdsNode::Role::kRequests);
    node_.subscribe(
        name, ros::definition_of<ros::TriggerResponse>(), kReliableQos,
        DdsNode::PublisherHandler(
            [this](std::string_view cdr, const std::string& topic, std::uint64_t) {
              const std::lock_guard lock(mutex_);
              answers_.push_back(ros::from_cdr<ServiceCall<ros::TriggerResponse>>(cdr, topic));
            }),
        DdsNode::Role::kReplies);
    node_.start();
  }
  void go(const std::string& frame, double x, double y, double yaw) {
    ros::PoseStamped m;
    m.header.frame_id = frame;
    m.pose = {{x, y, 0.0}, {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}};
    node_.publish(goal_, m);
  }
  void say(const std::string& word) { node_.publish(told_, ros::String{word}); }
  void hold(std::int64_t number) {
    // Whatever its one byte says.
    node_.publish(
        asks_, ServiceCall<ros::TriggerRequest>{42, number, {static_cast<std::uint8_t>(number)}});
  }
  /// `child` is at (1, 2) in `parent`, and turned to the left by a right angle.
  void mount(const std::string& parent, const std::string& child) {
    ros::TransformStamped t;
    t.header.frame_id = parent;
    t.child_frame_id = child;
    t.transform.translation = {1.0, 2.0, 0.0};
    t.transform.rotation = {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)};
    node_.publish(transforms_, ros::TFMessage{{t}});
  }
  bool ready(const DdsOptions& o) const {
    return node_.subscribers(o.goal) > 0 && node_.subscribers(o.told) > 0;
  }
  std::vector<ServiceCall<ros::TriggerResponse>> answers() {
    const std::lock_guard lock(mutex_);
    return answers_;
  }

 private:
  std::mutex mutex_;
  std::vector<ServiceCall<ros::TriggerResponse>> answers_;
  int goal_ = -1, told_ = -1, transforms_ = -1, asks_ = -1;
  DdsNode node_;
};

TEST(DdsCommands, PeopleSendHoldAndCancel) {
  const DdsOptions options;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DriveRequests requests;
  const DdsCommands commands(options, node, transforms, requests);
  node.start();
  Person person(options);
  ASSERT_TRUE(within(kPatience, [&] { return person.ready(options); }));

  person.go("map", 3.0, 4.0, 0.5);
  std::optional<DriveRequests::Place> place;
  const auto taken = [&] { return (place = requests.take_place()).has_value(); };
  ASSERT_TRUE(within(kPatience, taken));
  EXPECT_EQ(place->position, Eigen::Vector2d(3.0, 4.0));
  EXPECT_NEAR(place->yaw.value(), 0.5, 1e-9);
  requests.tell({place->number, DetourState::kOnTheWay, ""});

  // Of another frame: where tf says.
  person.mount("map", "door");
  ASSERT_TRUE(within(kPatience, [&] { return transforms.newest("map", "door").has_value(); }));
  person.go("/door", 1.0, 0.0, 0.0);
  ASSERT_TRUE(within(kPatience, taken));
  EXPECT_NEAR(place->position.x(), 1.0, 1e-9);
  EXPECT_NEAR(place->position.y(), 3.0, 1e-9);
  EXPECT_NEAR(place->yaw.value(), M_PI_2, 1e-9);
  requests.tell({place->number, DetourState::kOnTheWay, ""});

  // Of an unknown one: refused, and nothing else changes.
  person.go("moon", 1.0, 0.0, 0.0);
  ASSERT_TRUE(within(kPatience, [&] { return requests.told_refused(); }));
  EXPECT_THAT(requests.told(), HasSubstr("/goal_pose: a goal in the frame 'moon', which tf"));
  EXPECT_FALSE(requests.take_place());
  EXPECT_EQ(requests.detour().state, DetourState::kOnTheWay);
  EXPECT_EQ(requests.take_notes().size(), 1u);

  person.say("cancel");
  ASSERT_TRUE(within(kPatience, [&] { return requests.take_cancellation(); }));
  EXPECT_FALSE(requests.told_to_drive());
  person.say("resume");
  ASSERT_TRUE(within(kPatience, [&] { return requests.told_to_drive(); }));
  person.say("jump");
  EXPECT_TRUE(within(kPatience, [&] {
    return requests.told() ==
           "/prospect/command: 'jump': no command; expected hold, resume, cancel or stop";
  }));
  person.say("acknowledge");  // asks for a topic of its own
  EXPECT_TRUE(within(kPatience,
                     [&] { return requests.told().find("'acknowledge'") != std::string::npos; }));
  EXPECT_FALSE(requests.take_acknowledgement());
  person.say("stop");
  EXPECT_TRUE(within(kPatience, [&] { return requests.emergency_stop_waits(); }));
  EXPECT_TRUE(node.faults().empty());
  node.stop();
}

TEST(DdsCommands, AServiceAnswersWhoAsked) {
  const DdsOptions options;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DriveRequests requests;
  const DdsCommands commands(options, node, transforms, requests);
  node.start();
  Person person(options);
  std::int64_t number = 0;
  ASSERT_TRUE(within(
      kPatience, [&] { return !person.answers().empty(); }, [&] { person.hold(++number); }));
  const auto answer = person.answers().front();
  EXPECT_EQ(answer.client, 42u);
  EXPECT_GE(answer.number, 1);
  EXPECT_LE(answer.number, number);
  EXPECT_TRUE(answer.body.success);
  EXPECT_FALSE(requests.told_to_drive());
  node.stop();
}

TEST(DdsCommands, AGoalThatCannotBeIsRefused) {
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  const DdsOptions::Frames frames;
  const auto refusal = [&](const ros::PoseStamped& m) -> std::string {
    try {
      goal_in_map(m, frames, transforms, "/goal_pose");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  ros::PoseStamped m;
  m.header.frame_id = "map";
  EXPECT_EQ(refusal(m), "accepted");
  ros::PoseStamped bad = m;
  bad.header.frame_id = "";
  EXPECT_THAT(refusal(bad), HasSubstr("without a frame"));
  bad = m;
  bad.pose.position.x = NAN;
  EXPECT_THAT(refusal(bad), HasSubstr("finite"));
  bad = m;
  bad.pose.orientation = {0.0, 0.0, 0.0, 0.0};
  EXPECT_THAT(refusal(bad), HasSubstr("unit quaternion"));
  bad = m;
  bad.pose.orientation = {0.0, -std::sqrt(0.5), 0.0, std::sqrt(0.5)};
  EXPECT_THAT(refusal(bad), HasSubstr("up or down"));
  bad.pose.orientation = {1.0, 0.0, 0.0, 0.0};  // w first
  EXPECT_THAT(refusal(bad), HasSubstr("a quaternion is x, y, z, w"));
}

}  // namespace
}  // namespace prospect::dds_commands_test
