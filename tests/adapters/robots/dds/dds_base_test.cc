// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_base_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kRobotsClock = 1000.0;  // [s] ahead of ours

/// The driver of a base at the other end.
class Driver {
 public:
  explicit Driver(const DdsOptions& options) : node_(test::dds_test_address("driver")) {
    odometry_ = node_.advertise<ros::Odometry>(options.odometry, kReliableQos);
    stop_ = node_.advertise<ros::Bool>(options.emergency_stop, kReliableQos);
    acknowledge_ = node_.advertise<ros::Bool>(options.acknowledge, kReliableQos);
    transforms_ = node_.advertise<ros::TFMessage>("/tf_static", kStaticTransformQos);
    node_.subscribe<ros::TwistStamped>(options.command.stamped, kCommandQos,
                                       [this](const ros::TwistStamped& m) {
                                         const std::lock_guard lock(mutex_);
                                         commands_.push_back(m);
                                       });
    node_.start();
  }
  void odometry(double speed, double x, const std::string& child = "base_link",
                const ros::Quaternion& orientation = {}) {
    ros::Odometry m;
    m.pose.pose.orientation = orientation;
    m.header = {ros::time_of(clock_.now() + kRobotsClock), "odom"};
    m.child_frame_id = child;
    m.pose.pose.position.x = x;
    m.twist.twist.linear.x = speed;
    m.twist.twist.angular.z = 0.5;
    node_.publish(odometry_, m);
  }
  void press(bool pressed) { node_.publish(stop_, ros::Bool{pressed}); }
  void acknowledge(bool yes) { node_.publish(acknowledge_, ros::Bool{yes}); }
  /// `child` lies ahead of `parent`, and is turned to the left by a right angle.
  void mount(const std::string& parent, const std::string& child, double ahead) {
    ros::TransformStamped t;
    t.header.frame_id = parent;
    t.child_frame_id = child;
    t.transform.translation.x = ahead;
    t.transform.rotation.z = t.transform.rotation.w = std::sqrt(0.5);
    node_.publish(transforms_, ros::TFMessage{{t}});
  }
  bool ready(const DdsOptions& o) const {
    return node_.subscribers(o.odometry) > 0 && node_.subscribers(o.emergency_stop) > 0 &&
           node_.subscribers(o.acknowledge) > 0 && node_.publishers(o.command.stamped) > 0;
  }
  std::vector<ros::TwistStamped> commands() {
    const std::lock_guard lock(mutex_);
    return commands_;
  }

 private:
  SteadyClock clock_;
  DdsNode node_;
  int odometry_ = -1, stop_ = -1, acknowledge_ = -1, transforms_ = -1;
  std::mutex mutex_;
  std::vector<ros::TwistStamped> commands_;
};

TEST(DdsBase, DrivesAndHearsABaseBehindTopics) {
  DdsOptions options;
  options.emergency_stop = "/emergency_stop";
  options.acknowledge = "/acknowledge";
  options.command.dead_man = 0.5;
  options.command.limits.speed = 0.6;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DriveRequests requests;
  DdsBase base(options, node, transforms, clock, &requests);
  node.start();
  EXPECT_EQ(base.dead_man(), 0.5);
  EXPECT_EQ(base.limits().speed, 0.6);
  EXPECT_FALSE(base.report().connected);

  Driver driver(options);
  ASSERT_TRUE(within(kPatience, [&] { return driver.ready(options); }));
  EXPECT_TRUE(driver.commands().empty()) << "nothing is sent unasked";

  // Odometry until the robot's clock is known, 0.5 s.
  BaseReport heard;
  const double begin = clock.now();
  int came = 0;
  ASSERT_TRUE(within(
      kPatience,
      [&] {
        const BaseReport report = base.report();
        came += static_cast<int>(report.wheels.size());
        if (report.connected) heard = report;
        return report.connected && clock.now() > begin + 0.8 && came > 5;
      },
      [&] { driver.odometry(0.25, 3.0); }));
  EXPECT_EQ(heard.velocity.linear.x(), 0.25);
  EXPECT_EQ(heard.velocity.yaw_rate, 0.5);
  EXPECT_TRUE(heard.faults.empty());
  EXPECT_NEAR(ros::seconds(base.ros_time(clock.now())), clock.now() + kRobotsClock, 0.2);
  EXPECT_EQ(base.odometry(clock.now())->translation().x(), 3.0);

  base.send({{0.2, 0.0, 0.0}, -0.3}, clock.now() + 1.0);
  ASSERT_TRUE(within(kPatience, [&] { return driver.commands().size() == 1; }));
  EXPECT_EQ(driver.commands()[0].twist.linear.x, 0.2);
  EXPECT_EQ(driver.commands()[0].twist.angular.z, -0.3);
  EXPECT_EQ(driver.commands()[0].header.frame_id, "base_link");
  base.send({{0.9, 0.0, 0.0}, 0.0}, clock.now() - 0.1);  // has expired
  base.send({{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, 0.0}, clock.now() + 1.0);
  ASSERT_TRUE(within(kPatience, [&] { return driver.commands().size() == 2; }));
  EXPECT_EQ(driver.commands()[1].twist.linear.x, 0.0) << "no number is a stop";

  const auto button = [&] { return base.emergency_stop()->state(clock.now()); };
  EXPECT_FALSE(button().silent.empty()) << "nobody has said whether it is pressed";
  for (const bool pressed : {true, false}) {
    driver.press(pressed);
    EXPECT_TRUE(
        within(kPatience, [&] { return button().silent.empty() && button().pressed == pressed; }));
  }
  EXPECT_TRUE(within(kPatience, [&] { return !button().silent.empty(); })) << "no word for a time";

  EXPECT_FALSE(requests.take_acknowledgement());
  driver.acknowledge(false);
  driver.acknowledge(true);
  EXPECT_TRUE(within(kPatience, [&] { return requests.take_acknowledgement(); }));

  // One bad sample among good ones decides nothing, whatever is wrong with it; several do.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Bad {
    double speed;
    const char *child, *expected;
    ros::Quaternion orientation{};
  };
  for (const Bad& bad :
       {Bad{nan, "base_link", "/odom: not a motion; expected finite numbers"},
        Bad{0.25, "wheel", "/odom: child_frame_id is 'wheel'; expected 'base_link'"},
        Bad{0.25, "base_link", "a quaternion is x, y, z, w", {1.0, 0.0, 0.0, 0.0}}}) {
    for (int k = 0; k < 30; ++k) {
      k % 10 == 5 ? driver.odometry(bad.speed, 3.0, bad.child, bad.orientation)
                  : driver.odometry(0.25, 3.0);
      clock.wait_until(clock.now() + 0.01, {});
      EXPECT_TRUE(base.report().faults.empty()) << bad.expected;
    }
    EXPECT_TRUE(within(
        kPatience, [&] { return !node.fault("/odom").empty(); },
        [&] { driver.odometry(bad.speed, 3.0, bad.child, bad.orientation); }));
    EXPECT_THAT(base.report().faults, Contains(HasSubstr(bad.expected)));
    EXPECT_TRUE(within(
        kPatience, [&] { return base.report().faults.empty(); },
        [&] { driver.odometry(0.25, 3.0); }));
  }
  EXPECT_TRUE(within(kPatience, [&] {
    const auto faults = base.report().faults;
    return std::find(faults.begin(), faults.end(), "/odom: odometry is silent") != faults.end();
  }));
}

// A publisher that says it once: that it is there is what counts.
TEST(DdsBase, ALatchedEmergencyStopIsThereAsLongAsItsPublisherIs) {
  DdsOptions options;
  options.emergency_stop = "/emergency_stop";
  options.emergency_stop_contract = {.max_age = 0.5, .latched = true};
  options.command.dead_man = 0.5;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DdsBase base(options, node, transforms, clock);
  node.start();
  const auto silent = [&] {
    base.report();
    return base.emergency_stop()->state(clock.now()).silent;
  };
  EXPECT_EQ(silent(),
            "/emergency_stop: 0 of 1 publishers are there and have said whether it is pressed");
  const auto publish = [](DdsNode& button, const DdsQos& qos) {
    const int topic = button.advertise<ros::Bool>("/emergency_stop", qos);
    button.start();
    button.publish(topic, ros::Bool{false});
  };
  {
    DdsNode late(test::dds_test_address("late"));
    publish(late, {true, true, 1, 0.4});
    EXPECT_TRUE(within(kPatience, [&] { return silent().empty(); }));
    const double since = clock.now();
    EXPECT_TRUE(within(
        kPatience, [&] { return clock.now() > since + 1.0; }, [&] { EXPECT_EQ(silent(), ""); }));
  }
  EXPECT_TRUE(within(kPatience, [&] { return !silent().empty(); })) << "it has gone";
  // One that promises no sign of life, or keeps nothing for who comes late, is not connected.
  for (const DdsQos& qos : {DdsQos{true, true, 1}, DdsQos{true, false, 1, 0.4}}) {
    DdsNode other(test::dds_test_address("other"));
    publish(other, qos);
    EXPECT_TRUE(within(kPatience, [&] { return !node.fault("/emergency_stop").empty(); }));
    EXPECT_THAT(base.report().faults,
                Contains(HasSubstr("expected one that fits a subscription that is reliable, "
                                   "transient local, with a liveliness lease of 0.5 s")));
    EXPECT_FALSE(silent().empty());
  }
}

// Whoever else commands, or says how it moves, is found by who publishes, before a word of it.
TEST(DdsBase, ASecondCommanderOrASecondOdometryIsAFaultThatNamesBoth) {
  DdsOptions options;
  options.emergency_stop = "/emergency_stop";
  options.acknowledge = "/acknowledge";
  options.command.dead_man = 0.5;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DriveRequests requests;
  DdsBase base(options, node, transforms, clock, &requests);
  node.start();
  Driver driver(options);
  const auto drives = [&] { driver.odometry(0.25, 3.0); };
  const auto is_fine = [&] {
    const BaseReport report = base.report();
    return report.connected && report.faults.empty();
  };
  const auto faults = [&] { return base.report().faults; };
  ASSERT_TRUE(within(
      kPatience, [&] { return driver.ready(options) && is_fine(); }, drives));
  {
    // Who listens with another type hears nothing, and is nobody who commands.
    DdsNode listener(test::dds_test_address("listener"));
    listener.subscribe<ros::Twist>("/cmd_vel", kCommandQos, [](const ros::Twist&) {});
    listener.start();
    const auto told = [&] {
      const auto all = node.faults();
      return std::find(all.begin(), all.end(),
                       "/cmd_vel: another node expects geometry_msgs/msg/Twist; expected "
                       "geometry_msgs/msg/TwistStamped") != all.end();
    };
    EXPECT_TRUE(within(kPatience, told, drives)) << "it is said";
    const double since = clock.now();
    EXPECT_TRUE(within(
        kPatience, [&] { return clock.now() > since + 0.4; },
        [&] {
          drives();
          EXPECT_TRUE(is_fine());
        }));
  }
  for (const bool stamped : {true, false}) {
    DdsNode teleop(test::dds_test_address("teleop"));
    stamped ? teleop.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos)
            : teleop.advertise<ros::Twist>("/cmd_vel", kCommandQos);
    teleop.start();
    EXPECT_TRUE(within(
        kPatience,
        [&] {
          const auto all = faults();
          return std::find(all.begin(), all.end(),
                           "/cmd_vel: published by /prospect (this program), /teleop; expected one "
                           "publisher") != all.end();
        },
        drives))
        << ::testing::PrintToString(faults());
  }
  ASSERT_TRUE(within(kPatience, is_fine, drives)) << "it has gone";
  {
    DdsNode other(test::dds_test_address("other"));
    const int odometry = other.advertise<ros::Odometry>("/odom", kReliableQos);
    other.start();
    ros::Odometry m;
    m.child_frame_id = "base_link";
    m.twist.twist.linear.x = 5.0;
    EXPECT_TRUE(within(
        kPatience,
        [&] {
          const BaseReport report = base.report();
          EXPECT_EQ(report.velocity.linear.x(), 0.25) << "what it says does not count";
          return std::find(report.faults.begin(), report.faults.end(),
                           "/odom: published by /driver, /other; expected one publisher") !=
                 report.faults.end();
        },
        [&] {
          drives();
          other.publish(odometry, m);
        }))
        << ::testing::PrintToString(faults());
  }
  EXPECT_TRUE(within(kPatience, is_fine, drives));
}

TEST(DdsBase, CarriesTheMotionOfAFrameThatTfKnowsOverToTheBody) {
  DdsOptions options;
  options.emergency_stop = "/emergency_stop";
  options.acknowledge = "/acknowledge";
  options.odometry_by_tf = true;
  options.command.dead_man = 0.5;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DriveRequests requests;
  DdsBase base(options, node, transforms, clock, &requests);
  node.start();
  Driver driver(options);
  ASSERT_TRUE(within(kPatience, [&] { return driver.ready(options); }));

  EXPECT_TRUE(within(
      kPatience, [&] { return !node.fault("/odom").empty(); },
      [&] { driver.odometry(0.25, 3.0, "wheel"); }));
  EXPECT_THAT(node.fault("/odom"), HasSubstr("no transform from its child_frame_id 'wheel'"));
  // 0.4 m ahead of the body, looking left: it moves by 0.25 m/s that way while the body turns by
  // 0.5 rad/s, which by itself moves it by 0.2 m/s.
  BaseReport heard;
  ASSERT_TRUE(within(
      kPatience,
      [&] {
        const BaseReport report = base.report();
        if (!report.wheels.empty()) heard = report;
        return !heard.wheels.empty();
      },
      [&] {
        driver.mount("base_link", "wheel", 0.4);
        driver.odometry(0.25, 3.0, "wheel");
      }));
  EXPECT_NEAR(heard.wheels.back().velocity.x(), 0.0, 1e-12);
  EXPECT_NEAR(heard.wheels.back().velocity.y(), 0.05, 1e-12);
  EXPECT_NEAR(heard.wheels.back().yaw_rate, 0.5, 1e-12);
  // The body is 0.4 m to the right of the frame, which is not turned against odom.
  const Eigen::Isometry3d T = *base.odometry(clock.now());
  EXPECT_NEAR(T.translation().x(), 3.0, 1e-9);
  EXPECT_NEAR(std::abs(T.translation().y()), 0.4, 1e-9);
}

TEST(DdsBase, AStampedTwistIsAMotionAndAddsUpToAPose) {
  DdsOptions options;
  options.odometry_type = ros::TwistWithCovarianceStamped::kType;
  options.command.dead_man = 0.5;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  DdsBase base(options, node, transforms, clock);
  node.start();
  DdsNode driver(test::dds_test_address("driver"));
  const int topic = driver.advertise<ros::TwistWithCovarianceStamped>("/odom", kReliableQos);
  driver.start();
  ASSERT_TRUE(within(kPatience, [&] { return driver.subscribers("/odom") > 0; }));
  // Half a turn to the left along an arc of 1 m radius, in ten seconds of its own time.
  ros::TwistWithCovarianceStamped m;
  m.header.frame_id = "base_link";
  m.twist.twist.linear.x = m.twist.twist.angular.z = 0.1 * M_PI;
  std::vector<WheelSample> came;
  const auto tell = [&](double stamp) {
    m.header.stamp = ros::time_of(stamp);
    driver.publish(topic, m);
  };
  const auto come = [&](std::size_t count) {
    return within(kPatience, [&] {
      for (const WheelSample& sample : base.report().wheels) came.push_back(sample);
      return came.size() >= count;
    });
  };
  for (std::size_t n = 0; n <= 10; ++n) {
    tell(100.0 + static_cast<double>(n));
    ASSERT_TRUE(come(n + 1));
  }
  EXPECT_NEAR(came.back().velocity.x(), 0.1 * M_PI, 1e-12);
  EXPECT_NEAR(came.back().yaw_rate, 0.1 * M_PI, 1e-12);
  EXPECT_EQ(came.back().stamp, 110.0);
  const Eigen::Isometry3d T = *base.odometry(clock.now() + 1e6);  // the newest
  EXPECT_LT((T.translation() - Eigen::Vector3d(0.0, 2.0, 0.0)).norm(), 1e-9);
  EXPECT_NEAR(T.linear()(0, 0), -1.0, 1e-9);

  for (const auto& [stamp, variance, expected] :
       {std::tuple(0.0, 0.0, "a motion without a stamp"), std::tuple(120.0, -1.0, "a variance")}) {
    m.twist.covariance[0] = variance;
    EXPECT_TRUE(within(
        kPatience, [&] { return node.fault("/odom").find(expected) != std::string::npos; },
        [&, at = stamp] { tell(at); }))
        << expected;
  }
}

}  // namespace
}  // namespace prospect::dds_base_test
