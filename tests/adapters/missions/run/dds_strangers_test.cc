// SPDX-License-Identifier: Apache-2.0
// Strangers on the network of a robot, of another vendor: they listen with another type, say how it
// moves, command it, and let the emergency stop fall silent.
#include <gtest/gtest.h>

#ifdef PROSPECT_WITH_FASTDDS

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/std_msgs.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/dds_run.h"
#include "adapters/robots/dds/dds_relay.h"
#include "runtime/drive_requests.h"
#include "tests/adapters/box_room.h"
#include "tests/adapters/dds_lidar_robot.h"
#include "tests/adapters/dds_pair.h"
#include "tests/adapters/fast_node.h"

namespace prospect::dds_strangers_test {
namespace {

using test::FastNode;
using test::kPatience;
using test::within;

double time_of_day() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

ros::TwistStamped forward(double speed, double stamp) {
  ros::TwistStamped m;
  m.header = {ros::time_of(stamp), "base_link"};
  m.twist.linear.x = speed;
  return m;
}

TEST(DdsStrangers, TheRelayIsTheLastGate) {
  DdsOptions options;
  options.address = test::dds_test_address("relay");
  options.command.relay = "/prospect/cmd_vel";
  options.command.dead_man = 0.5;
  options.command.limits = {0.5, 1.0, 100.0, 100.0};
  std::mutex mutex;
  std::string told;
  DdsRelay relay(options);
  std::jthread runs([&](const std::stop_token& stop) {
    relay.run([&] { return stop.stop_requested(); },
              [&](const std::string& line) {
                const std::lock_guard lock(mutex);
                told += line + '\n';
              });
  });
  const auto says = [&](const std::string& text) {
    const std::lock_guard lock(mutex);
    return told.find(text) != std::string::npos;
  };
  FastNode motors(test::dds_test_address("motors"));
  std::atomic<double> newest = -1.0, fastest = 0.0;
  motors.subscribe<ros::TwistStamped>("/cmd_vel", kCommandQos, [&](const ros::TwistStamped& m) {
    newest = m.twist.linear.x;
    fastest = std::max(fastest.load(), m.twist.linear.x);
  });
  FastNode commander(test::dds_test_address("commander"));
  const int topic = commander.advertise<ros::TwistStamped>("/prospect/cmd_vel", kCommandQos);
  const auto commands = [&](double speed, double age = 0.0) {
    return [&, speed, age] { commander.publish(topic, forward(speed, time_of_day() - age)); };
  };
  ASSERT_TRUE(within(
      kPatience, [&] { return newest == 0.3; }, commands(0.3)));
  EXPECT_TRUE(within(kPatience, [&] { return newest == 0.0; })) << "silence";

  ASSERT_TRUE(within(
      kPatience, [&] { return newest == 0.5; }, commands(50.0)));
  EXPECT_EQ(fastest, 0.5);
  EXPECT_TRUE(within(kPatience, [&] { return says("a command is 50 m/s"); }));
  EXPECT_TRUE(within(kPatience, [&] { return newest == 0.0; }));

  EXPECT_TRUE(within(
      kPatience, [&] { return says("a command is stamped 30 s ago"); }, commands(0.2, 30.0)));
  EXPECT_FALSE(within(
      0.3, [&] { return newest > 0.0; }, commands(0.2, 30.0)));

  {
    FastNode other(test::dds_test_address("teleop"));
    const int its = other.advertise<ros::TwistStamped>("/prospect/cmd_vel", kCommandQos);
    const auto both = [&] {
      commander.publish(topic, forward(0.1, time_of_day()));
      other.publish(its, forward(0.2, time_of_day()));
    };
    EXPECT_TRUE(within(
        kPatience,
        [&] { return says("2 publishers of commands") && says("commander") && says("teleop"); },
        both));
    EXPECT_TRUE(within(
        kPatience, [&] { return newest == 0.0; }, both));
    EXPECT_FALSE(within(
        0.3, [&] { return newest > 0.0; }, both));
  }
  EXPECT_TRUE(within(
      kPatience, [&] { return newest == 0.3; }, commands(0.3)))
      << "one is left";
}

/// Who looks at a robot from outside, and may press and acknowledge.
class Operator {
 public:
  explicit Operator(const DdsOptions& options) : node_(test::dds_test_address("operator")) {
    node_.subscribe<ros::DiagnosticStatus>(options.output.state, kReliableQos,
                                           [this](const ros::DiagnosticStatus& m) {
                                             const std::lock_guard lock(mutex_);
                                             state_ = m.message;
                                             for (const ros::KeyValue& value : m.values)
                                               state_ += ' ' + value.value;
                                           });
    stop_ = node_.advertise<ros::Bool>(options.emergency_stop, kReliableQos);
    acknowledge_ = node_.advertise<ros::Bool>(options.acknowledge, kReliableQos);
  }
  /// Says that it is not pressed, while it is there.
  void tell() {
    if (there) node_.publish(stop_, ros::Bool{false});
  }
  void acknowledge() { node_.publish(acknowledge_, ros::Bool{true}); }
  bool sees(const std::string& text) {
    const std::lock_guard lock(mutex_);
    return state_.find(text) != std::string::npos;
  }
  std::string state() {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  bool there = true;

 private:
  FastNode node_;
  std::mutex mutex_;
  std::string state_;
  int stop_ = -1, acknowledge_ = -1;
};

DdsOptions topics() {
  DdsOptions o;
  o.address = test::dds_test_address("prospect");
  o.timeout = kPatience;
  o.pose_source = DdsOptions::PoseSource::kTf;
  o.pose.frame = o.frames.base;
  o.stereo.left = o.stereo.left_info = o.stereo.right = o.stereo.right_info = "";
  o.depth.image = o.depth.info = "";
  o.scan = "/scan";
  o.emergency_stop = "/emergency_stop";
  o.acknowledge = "/acknowledge";
  o.command.dead_man = 0.5;
  o.output.transforms = false;
  o.output.map = "/prospect/map";
  return o;
}

TEST(DdsStrangers, AreNoticedWhileItDrives) {
  const Configuration c = configuration_from_text(
      "robot:\n"
      "  shape: {type: cylinder, radius: 0.18, height: 0.4, center: [0, 0, 0.3]}\n"
      "  depth: {max_range: 3, mount: {position: [0.05, 0, 0.3]}}\n"
      "drive: {preflight: {turn: 0.15, distance: 0.03}}\n"
      "mission: {time_limit: 90}\n",
      "lidar");
  const World world = test::box_room(14.0, 8.0);
  const DdsOptions options = topics();
  test::DdsLidarRobot robot(world, c.robot, options, test::dds_test_address("robot"));
  Operator person(options);
  std::atomic<bool> over = false;
  std::string story;
  std::thread strangers([&] {
    const auto waits = [&](const std::string& state) {
      const bool came = within(
          kPatience, [&] { return person.sees(state); }, [&] { person.tell(); });
      story += (came ? state : "no " + state + " but " + person.state()) + '\n';
    };
    const auto stays = [&](double seconds, const std::string& state) {
      return !within(
          seconds, [&] { return !person.sees(state); }, [&] { person.tell(); });
    };
    const auto goes_on = [&] {
      within(
          kPatience, [&] { return person.sees("active"); },
          [&] {
            person.tell();
            person.acknowledge();
          });
    };
    waits("active");
    {
      FastNode listener(test::dds_test_address("listener"));
      listener.subscribe<ros::Twist>("/cmd_vel", kCommandQos, [](const ros::Twist&) {});
      story += stays(2.0, "active") ? "a listener is none\n" : person.state() + '\n';
    }
    {
      FastNode other(test::dds_test_address("odometer"));
      const int odometry = other.advertise<ros::Odometry>("/odom", kReliableQos);
      ros::Odometry m;
      m.child_frame_id = "base_link";
      m.twist.twist.linear.x = 5.0;
      other.publish(odometry, m);
      waits("base fault");
    }
    goes_on();
    {
      FastNode teleop(test::dds_test_address("teleop"));
      const int commands = teleop.advertise<ros::TwistStamped>("/cmd_vel", kCommandQos);
      teleop.publish(commands, forward(0.3, time_of_day()));
      waits("base fault");
    }
    goes_on();
    person.there = false;
    waits("emergency stop silent");
    over = true;
  });
  DriveRequests requests;
  ExplorationRunOptions run;
  run.requests = &requests;
  run.cancelled = [&] { return over.load(); };
  const ExplorationRunResult result = explore_dds(c, options, run);
  over = true;
  strangers.join();
  robot.stop();
  EXPECT_EQ(story, "active\na listener is none\nbase fault\nbase fault\nemergency stop silent\n")
      << result.record.summary.detail << to_text(result.preflight);
  // Of events with one cause the newest is told.
  std::string said;
  for (const Event& event : result.events) said += event.text + '\n';
  using ::testing::HasSubstr;
  EXPECT_THAT(said, HasSubstr("teleop; expected one publisher"));
  EXPECT_THAT(said, HasSubstr("/emergency_stop: 0 of 1 publishers"));
  EXPECT_EQ(robot.body().collisions(), 0);
}

}  // namespace
}  // namespace prospect::dds_strangers_test

#else

TEST(DdsStrangers, AreNoticedWhileItDrives) {
  GTEST_SKIP() << "Fast DDS is not installed (libfastrtps-dev)";
}

#endif
