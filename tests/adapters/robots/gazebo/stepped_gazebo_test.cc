// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/stepped_gazebo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/fake_gazebo.h"

namespace prospect::stepped_gazebo_test {
namespace {

namespace msgs = gazebo::msgs;
using test::FakeGazebo;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Steady = std::chrono::steady_clock;

const std::string kTopics = "/gazebo/room/";
const std::string kStereo = "robot/base/stereo/images";
const std::string kDepth = "robot/base/depth/image";
const std::string kRear = "robot/base/depth_1/image";

/// A world that stands and is stepped, of Gazebo's habits: a camera looks when somebody listens; it
/// takes its first frame where it looks first at one of its instants, the others a period after
/// each other from there on; a frame comes when it is rendered, poses at most 60 times a second of
/// the machine.
struct SteppedRoom {
  static constexpr double kStep = 0.002;
  // What it is.
  std::string model = "robot";
  double depth_rate = 10.0;
  bool paused = true;
  double begins = 0.0;        // [s]
  std::int64_t omitted = -1;  // stereo frame that never comes
  std::chrono::milliseconds rendering{0};
  bool looks_at_each_step = true;  // until the first frame, or where the world stands
  bool tells_poses = true;         // by itself
  double silence = 5.0;            // [s] that it may take

  std::atomic<std::int64_t> steps{0};
  std::mutex mutex;
  std::array<double, 3> next = {NAN, NAN, NAN};         // [s] frame of stereo, of each depth
  double speed = 0.0, angle = 0.0;                      // in force; of the wheels
  std::vector<std::pair<std::int64_t, double>> driven;  // from which step on which speed
  Steady::time_point told{};
  std::jthread statistics;
  std::vector<std::jthread> renderers;
  std::set<std::string> listened;  // topics
  FakeGazebo gazebo{[this](const std::string& topic, std::string_view message) {
                      return answer(topic.substr(kTopics.size()), message);
                    },
                    [this](const std::string& topic) {
                      const std::lock_guard lock(mutex);
                      FakeGazebo::Answers out;
                      listened.insert(topic.substr(kTopics.size()));
                      if (steps > 0) look(out, true);
                      return out;
                    }};

  SteppedRoom() {
    statistics = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        msgs::WorldStatistics out;
        const double now = begins + static_cast<double>(steps) * kStep;
        out.mutable_sim_time()->set_sec(FakeGazebo::whole(now));
        out.mutable_sim_time()->set_nsec(FakeGazebo::whole(1e9 * (now - std::floor(now))));
        out.set_paused(paused);
        gazebo.publish(kTopics + "world_stats", out);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }
  ~SteppedRoom() {
    statistics = {};
    renderers.clear();
  }

  FakeGazebo::Answers answer(const std::string& topic, std::string_view bytes) {
    const std::lock_guard lock(mutex);
    if (topic == "request") return {{kTopics + "response", response(bytes)}};
    if (topic == "robot/vel_cmd") {
      msgs::Pose velocity;
      velocity.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
      speed = velocity.position().x();
    }
    FakeGazebo::Answers out;
    if (topic == "world_control") {
      msgs::WorldControl control;
      control.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
      for (unsigned n = 1; n <= control.multi_step(); ++n) {
        step(out, looks_at_each_step || n == control.multi_step());
      }
    }
    return out;
  }

  std::string response(std::string_view bytes) const {
    msgs::Request request;
    request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
    msgs::Response out;
    out.set_id(request.id());
    out.set_request(request.request());
    out.set_response("success");
    if (request.request() == "physics_info") {
      msgs::Physics physics;
      physics.set_max_step_size(kStep);
      out.set_serialized_data(physics.SerializeAsString());
    } else if (request.data() == model) {
      msgs::Model robot;
      robot.set_name(model);
      place(robot.mutable_pose(), 0.0);
      for (const char* name : {"robot::base", "robot::left_wheel", "robot::right_wheel"}) {
        msgs::Link* const link = robot.add_link();
        link->set_name(name);
        place(link->mutable_pose(), std::string(name) == "robot::base" ? 0.0 : angle);
      }
      for (const auto& [name, rate] :
           {std::pair("stereo", 15.0), std::pair("depth", depth_rate), std::pair("depth_1", 5.0)}) {
        msgs::Sensor* const sensor = robot.mutable_link(0)->add_sensor();
        sensor->set_name(name);
        sensor->set_update_rate(rate);
      }
      out.set_serialized_data(robot.SerializeAsString());
    } else {
      out.set_response("nonexistent");
    }
    return out.SerializeAsString();
  }

  /// Turned about its y axis.
  static void place(msgs::Pose* pose, double turned) {
    pose->mutable_position()->set_x(0.0);
    pose->mutable_position()->set_y(0.0);
    pose->mutable_position()->set_z(0.0);
    pose->mutable_orientation()->set_x(0.0);
    pose->mutable_orientation()->set_y(std::sin(0.5 * turned));
    pose->mutable_orientation()->set_z(0.0);
    pose->mutable_orientation()->set_w(std::cos(0.5 * turned));
  }

  static void picture(msgs::Image* image, const std::string& data) {
    image->set_width(1);
    image->set_height(1);
    image->set_pixel_format(1);
    image->set_step(0);
    image->set_data(data);
  }

  /// Whether a camera takes a frame now.
  bool takes(const std::string& topic, double& frame, double rate, bool looks) const {
    const double now = static_cast<double>(steps) * kStep;
    if (!listened.contains(topic)) return false;
    if (std::isnan(frame) && looks && std::fmod(now, 1.0 / rate) < kStep - 1e-9) frame = now;
    if (!(now >= frame - 0.5 * kStep - 1e-9)) return false;
    frame += 1.0 / rate;
    return true;
  }

  void step(FakeGazebo::Answers& out, bool looks) {
    if (driven.empty() || driven.back().second != speed) driven.emplace_back(steps, speed);
    ++steps;
    angle += speed * kStep / GazeboOptions().wheel_radius;
    const double now = static_cast<double>(steps) * kStep;
    msgs::Contacts contacts;
    FakeGazebo::stamp(contacts, now);
    out.emplace_back(kTopics + "physics/contacts", contacts.SerializeAsString());
    if (tells_poses && Steady::now() - told > std::chrono::microseconds(16667)) {
      told = Steady::now();
      msgs::PosesStamped poses;
      FakeGazebo::stamp(poses, now);
      for (const char* name : {"robot", "robot::left_wheel", "robot::right_wheel"}) {
        msgs::Pose* const pose = poses.add_pose();
        place(pose, std::string(name) == "robot" ? 0.0 : angle);
        pose->set_name(name);
      }
      out.emplace_back(kTopics + "pose/info", poses.SerializeAsString());
    }
    look(out, looks);
  }

  /// All cameras, at this step.
  void look(FakeGazebo::Answers& out, bool looks) {
    const double now = static_cast<double>(steps) * kStep;
    if (takes(kStereo, next[0], 15.0, looks) && std::floor(now * 15.0 + 1e-6) != omitted) {
      msgs::ImagesStamped pair;
      FakeGazebo::stamp(pair, now);
      picture(pair.add_image(), "l");
      picture(pair.add_image(), "r");
      render(out, kStereo, pair.SerializeAsString());
    }
    if (takes(kDepth, next[1], 10.0, looks)) {
      const float metres = 1.0f;
      msgs::ImageStamped depth;
      FakeGazebo::stamp(depth, now);
      picture(depth.mutable_image(), std::string(reinterpret_cast<const char*>(&metres), 4));
      render(out, kDepth, depth.SerializeAsString());
    }
    if (takes(kRear, next[2], 5.0, looks)) {
      const float metres = 2.0f;
      msgs::ImageStamped depth;
      FakeGazebo::stamp(depth, now);
      picture(depth.mutable_image(), std::string(reinterpret_cast<const char*>(&metres), 4));
      render(out, kRear, depth.SerializeAsString());
    }
  }

  void render(FakeGazebo::Answers& out, const std::string& topic, std::string bytes) {
    if (rendering.count() == 0) {
      out.emplace_back(kTopics + topic, std::move(bytes));
      return;
    }
    renderers.emplace_back([this, topic, bytes = std::move(bytes)] {
      std::this_thread::sleep_for(rendering);
      gazebo.publish(kTopics + topic, bytes);
    });
  }

  GazeboOptions options() const {
    GazeboOptions options = gazebo.options();
    options.silence = silence;
    options.depth_sensors = 2;
    return options;
  }
};

/// A line for all that a drive tells, and from which steps on which speed was in force.
struct Told {
  std::vector<std::string> lines;
  std::vector<double> speeds;  // of the wheels
  std::vector<std::pair<std::int64_t, double>> driven;
  std::string fault;
};

Told drive(SteppedRoom& room) {
  Told all;
  SteppedGazebo gazebo(room.options());
  const auto line = [&](const char* what, double stamp, double value) {
    char text[80];
    std::snprintf(text, sizeof text, "%s %.17g %.17g at %.3f", what, stamp, value, gazebo.time());
    all.lines.emplace_back(text);
  };
  SteppedGazebo::Told told;
  told.frame = [&](const SensorFrame& frame) {
    const auto* wheels = std::get_if<WheelSample>(&frame);
    if (wheels) all.speeds.push_back(wheels->velocity.x());
    const auto* depth = std::get_if<DepthFrame>(&frame);
    if (depth) {
      EXPECT_EQ(depth->image->at(0, 0), depth->sensor == 0 ? 1.0f : 2.0f);
    }
    line(wheels               ? "wheels"
         : !depth             ? "pair"
         : depth->sensor == 0 ? "depth"
                              : "rear",
         wheels ? wheels->stamp : stamp_of(frame), wheels ? wheels->velocity.x() : 0.0);
  };
  told.pose = [&](double stamp, const Pose& pose) { line("pose", stamp, pose.yaw); };
  gazebo.advance({}, 1.1, told);
  gazebo.advance({{0.4, 0.0, 0.0}, 0.0}, 1.25, told);
  gazebo.advance({{0.2, 0.0, 0.0}, 0.0}, 1.4, told);
  all.fault = gazebo.fault();
  const std::lock_guard lock(room.mutex);
  all.driven = room.driven;
  return all;
}

TEST(SteppedGazebo, TellsTheSameHoweverBusyTheMachineIs) {
  SteppedRoom fast, slow;
  slow.rendering = std::chrono::milliseconds(40);
  slow.looks_at_each_step = false;
  slow.tells_poses = false;
  const Told one = drive(fast), other = drive(slow);
  EXPECT_EQ(one.fault, "");
  EXPECT_EQ(other.fault, "");
  EXPECT_EQ(one.lines, other.lines);
  EXPECT_THAT(one.driven, ElementsAre(std::pair(0, 0.0), std::pair(550, 0.4), std::pair(625, 0.2)));
  EXPECT_EQ(one.driven, other.driven);
  const auto count = [&](const char* what) {
    return std::count_if(one.lines.begin(), one.lines.end(),
                         [&](const std::string& line) { return line.rfind(what, 0) == 0; });
  };
  EXPECT_EQ(count("pair"), 6) << "the 15th to the 20th";
  EXPECT_EQ(count("depth"), 4) << "that of 1.4 s is due a step later";
  EXPECT_EQ(count("rear"), 2) << "those of 1 and 1.2 s are due a step later, too";
  ASSERT_EQ(one.speeds.size(), 9u) << "at each pair, and at the end of each command";
  EXPECT_NEAR(one.speeds[2], 0.0, 1e-9);
  EXPECT_NEAR(one.speeds[3], 0.4, 1e-9);
  EXPECT_NEAR(one.speeds[6], 0.2, 1e-9);
}

TEST(SteppedGazebo, AServerThatEndsIsAFault) {
  SteppedRoom room;
  SteppedGazebo gazebo(room.options());
  const SteppedGazebo::Told told{[](const SensorFrame&) {}};
  gazebo.advance({}, 1.1, told);
  EXPECT_EQ(gazebo.fault(), "");
  room.gazebo.end();
  gazebo.advance({}, 2.0, told);
  EXPECT_NE(gazebo.fault(), "");
  const double stood = gazebo.time();
  gazebo.advance({}, 3.0, told);
  EXPECT_EQ(gazebo.time(), stood);
}

TEST(SteppedGazebo, AFrameThatDoesNotComeIsAFault) {
  SteppedRoom room;
  room.omitted = 17;
  room.silence = 1.5;
  EXPECT_THAT(drive(room).fault, HasSubstr("no frame of 'stereo' within 1.5 s"));
}

TEST(SteppedGazebo, RefusesWhatCannotBeStepped) {
  const auto refusal = [](void (*change)(SteppedRoom&)) -> std::string {
    SteppedRoom room;
    change(room);
    try {
      SteppedGazebo(room.options());
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(refusal([](SteppedRoom& r) { r.paused = false; }), HasSubstr("the world runs"));
  EXPECT_THAT(refusal([](SteppedRoom& r) { r.begins = 7.0; }), HasSubstr("has run, at 7.000 s"));
  EXPECT_THAT(refusal([](SteppedRoom& r) { r.model = "rover"; }), HasSubstr("no 'robot'"));
  EXPECT_THAT(refusal([](SteppedRoom& r) { r.depth_rate = 0.0; }), HasSubstr("'depth' at 0 Hz"));
}

}  // namespace
}  // namespace prospect::stepped_gazebo_test
