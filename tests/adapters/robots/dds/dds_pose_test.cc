// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_pose_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

ros::Pose pose_at(double x, double y, double yaw) {
  return {{x, y, 0.1}, {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}};
}
ros::TransformStamped link(double stamp, const std::string& parent, const std::string& child,
                           const ros::Pose& at) {
  return {{ros::time_of(stamp), parent},
          child,
          {{at.position.x, at.position.y, at.position.z}, at.orientation}};
}

/// Who is told, and who localizes.
struct Pair {
  explicit Pair(const DdsOptions& o)
      : inbox(clock, in_runtime_clock()),
        node(test::dds_test_address("prospect")),
        transforms(node),
        pose(o, node, transforms, inbox),
        other(test::dds_test_address("localization")) {
    tf = other.advertise<ros::TFMessage>(o.tf, kTransformQos);
    fixed = other.advertise<ros::TFMessage>(o.tf_static, kStaticTransformQos);
    if (o.pose.type == ros::PoseStamped::kType) {
      topic = other.advertise<ros::PoseStamped>(o.pose.topic, kReliableQos);
    } else if (o.pose.type == ros::Odometry::kType) {
      topic = other.advertise<ros::Odometry>(o.pose.topic, kReliableQos);
    } else if (!o.pose.topic.empty()) {
      topic = other.advertise<ros::PoseWithCovarianceStamped>(o.pose.topic, kReliableQos);
    }
    node.start();
    other.start();
    EXPECT_TRUE(within(kPatience, [&] {
      return other.subscribers(o.tf) > 0 && other.subscribers(o.tf_static) > 0 &&
             (topic < 0 || other.subscribers(o.pose.topic) > 0);
    }));
  }
  static SensorInboxOptions in_runtime_clock() {
    SensorInboxOptions o;
    o.poses_in_runtime_clock = true;
    o.max_image_age = 100.0;
    return o;
  }
  /// The next pose that comes while `tell` is called again and again.
  std::optional<ExternalPose> next(const std::function<void()>& tell) {
    std::optional<SensorFrame> frame;
    within(
        kPatience, [&] { return (frame = inbox.take()).has_value(); }, tell);
    return frame ? std::optional(std::get<ExternalPose>(*frame)) : std::nullopt;
  }
  /// Until the topic's fault says so.
  bool refused(const std::string& about, const std::string& expected,
               const std::function<void()>& tell) {
    return within(
        kPatience, [&] { return node.fault(about).find(expected) != std::string::npos; }, tell);
  }

  SteadyClock clock;
  SensorInbox inbox;
  DdsNode node;
  DdsTransforms transforms;
  DdsPose pose;
  DdsNode other;
  int tf = -1, fixed = -1, topic = -1;
};

TEST(DdsPose, OfTfIsThatOfTheLinkThatIsBehind) {
  DdsOptions o;
  o.pose_source = DdsOptions::PoseSource::kTf;
  o.pose.sigma = 0.1;
  Pair pair(o);
  const double now = pair.clock.now();
  // map -> odom is stamped ahead, as AMCL does; odom -> base is that of the wheels.
  const auto tell = [&](double stamp, double x) {
    const ros::Pose odom = pose_at(1.0, 0.0, M_PI_2);
    pair.other.publish(pair.tf,
                       ros::TFMessage{{link(stamp - 0.3, "map", "odom", odom),
                                       link(stamp + 0.5, "map", "odom", odom),
                                       link(stamp, "odom", "base_link", pose_at(x, 0.0, 0.0))}});
  };
  const auto first = pair.next([&] { tell(now - 0.2, 2.0); });
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->stamp, now - 0.2, 1e-6);
  EXPECT_LT((first->T_WB.translation() - Eigen::Vector3d(1.0, 2.0, 0.2)).norm(), 1e-9);
  ASSERT_TRUE(first->T_OB) << "by odometry alone";
  EXPECT_LT((first->T_OB->translation() - Eigen::Vector3d(2.0, 0.0, 0.1)).norm(), 1e-9);
  EXPECT_NEAR(first->covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(first->covariance(3, 3), o.pose.sigma_yaw * o.pose.sigma_yaw, 1e-12);
  EXPECT_EQ(first->covariance(2, 2), 0.0);
  EXPECT_NEAR(pair.pose.wait().yaw, M_PI_2, 1e-9);
  // The same said again is no news; the next is.
  tell(now - 0.2, 2.0);
  const auto second = pair.next([&] { tell(now - 0.1, 3.0); });
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->T_WB.translation().y(), 3.0, 1e-9);
  EXPECT_FALSE(pair.inbox.take());
}

TEST(DdsPose, OfATopicIsCarriedOverToTheBodyWithItsCovariance) {
  DdsOptions o;
  o.pose_source = DdsOptions::PoseSource::kTopic;
  o.pose.topic = "/pose";
  o.pose.frame = "marker";
  Pair pair(o);
  const double now = pair.clock.now();
  ros::PoseWithCovarianceStamped m;
  m.header = {ros::time_of(now - 0.1), "map"};
  m.pose.pose = pose_at(5.0, 6.0, M_PI_2);
  m.pose.covariance[0] = 0.04, m.pose.covariance[7] = 0.09, m.pose.covariance[35] = 0.01;
  m.pose.covariance[14] = 1e6;
  const auto tell = [&] { pair.other.publish(pair.topic, m); };
  EXPECT_TRUE(pair.refused(o.pose.topic, "no transform from 'marker' (pose.frame)", tell));
  // The marker is 0.5 m ahead of the body, which looks along y.
  pair.other.publish(pair.fixed,
                     ros::TFMessage{{link(0.0, "base_link", "marker", pose_at(0.5, 0.0, 0.0))}});
  const auto pose = pair.next(tell);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->T_WB.translation() - Eigen::Vector3d(5.0, 5.5, 0.0)).norm(), 1e-9);
  // x of the body moves with the yaw, half a metre away.
  EXPECT_NEAR(pose->covariance(0, 0), 0.04 + 0.25 * 0.01, 1e-9);
  EXPECT_NEAR(pose->covariance(1, 1), 0.09, 1e-9);
  EXPECT_NEAR(pose->covariance(0, 3), 0.5 * 0.01, 1e-9);
  EXPECT_EQ(pose->covariance(2, 2), 0.0);
  EXPECT_NEAR(pair.pose.wait().position.y(), 5.5, 1e-9);

  ros::PoseWithCovarianceStamped wrong = m;
  wrong.header.frame_id = "odom";
  const auto tell_wrong = [&] { pair.other.publish(pair.topic, wrong); };
  EXPECT_TRUE(pair.refused(o.pose.topic, "frame_id is 'odom'; expected 'map'", tell_wrong));
  wrong = m, wrong.header.stamp = {};
  EXPECT_TRUE(pair.refused(o.pose.topic, "a pose without a stamp", tell_wrong));
  wrong = m, wrong.pose.covariance[7] = -1.0;
  EXPECT_TRUE(pair.refused(o.pose.topic, "a variance of -1", tell_wrong));
  wrong = m, wrong.pose.pose.orientation = {};
  wrong.pose.pose.orientation.w = 0.0;
  EXPECT_TRUE(pair.refused(o.pose.topic, "not a pose", tell_wrong));
  // A heading of 0.4 rad whose w was written first.
  wrong = m, wrong.pose.pose.orientation = {std::cos(0.2), 0.0, 0.0, std::sin(0.2)};
  EXPECT_TRUE(pair.refused(o.pose.topic, "lies on its side or its head", tell_wrong));
}

TEST(DdsPose, OfOtherTypes) {
  DdsOptions o;
  o.pose_source = DdsOptions::PoseSource::kTopic;
  o.pose.topic = "/pose";
  o.pose.frame = "base_link";
  o.pose.type = ros::PoseStamped::kType;
  {
    Pair pair(o);
    const ros::PoseStamped m{{ros::time_of(pair.clock.now()), "map"}, pose_at(1.0, 2.0, 0.3)};
    const auto pose = pair.next([&] { pair.other.publish(pair.topic, m); });
    ASSERT_TRUE(pose);
    EXPECT_NEAR(pose->T_WB.translation().y(), 2.0, 1e-12);
    EXPECT_NEAR(pose->covariance(1, 1), o.pose.sigma * o.pose.sigma, 1e-12) << "none is told";
  }
  o.pose.type = ros::Odometry::kType;
  Pair pair(o);
  ros::Odometry m;
  m.header = {ros::time_of(pair.clock.now()), "map"};
  m.child_frame_id = "base_link";
  m.pose.pose = pose_at(1.0, 2.0, 0.3);
  m.pose.covariance[0] = m.pose.covariance[7] = m.pose.covariance[35] = 0.25;
  const auto pose = pair.next([&] { pair.other.publish(pair.topic, m); });
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->covariance(3, 3), 0.25, 1e-12);
  m.child_frame_id = "wheel";
  EXPECT_TRUE(pair.refused(o.pose.topic, "child_frame_id is 'wheel'; expected 'base_link'",
                           [&] { pair.other.publish(pair.topic, m); }));
}

TEST(DdsPose, WithoutOneALineSaysWhoIsMissing) {
  DdsOptions o;
  o.timeout = 0.05;
  o.pose.topic = "/pose";
  for (const auto& [source, expected] :
       {std::pair(DdsOptions::PoseSource::kTf,
                  "/tf, /tf_static: no transform from 'base_link' to 'map' within 0.05 s"),
        std::pair(DdsOptions::PoseSource::kTopic, "/pose: no message within 0.05 s")}) {
    o.pose_source = source;
    const SteadyClock clock;
    SensorInbox inbox(clock, {});
    DdsNode node(test::dds_test_address("prospect"));
    DdsTransforms transforms(node);
    const DdsPose pose(o, node, transforms, inbox);
    node.start();
    try {
      pose.wait();
      FAIL();
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(expected));
    }
  }
}

}  // namespace
}  // namespace prospect::dds_pose_test
