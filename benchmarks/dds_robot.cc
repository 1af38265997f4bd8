// SPDX-License-Identifier: Apache-2.0
// A simulated robot behind topics of ROS 2, as `prospect drive --base dds` meets a real one: stereo
// images, depth images and their calibrations, odometry; it takes velocity commands, and stops by
// itself when they cease. With a pose from outside (pose.from) it has a lidar, wheels and somebody
// who localizes it instead of cameras (tests/adapters/dds_lidar_robot.h). Over loopback.
//
//   dds_robot FILE.yaml [WORLD] [--seconds T] [--image-rate HZ] [--vendor cyclone|fast]
//             [--set KEY=VALUE]...
//
// FILE.yaml is the one that `prospect drive --ros` gets. Prints at the end what is true: the way,
// contacts, the pose in the frame that the mission began in, and how often the dead-man stopped it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/pose_message.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/registries.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_options.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/camera_sensors.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "runtime/clock.h"
#include "tests/adapters/dds_lidar_robot.h"
#ifdef PROSPECT_WITH_FASTDDS
#include "tests/adapters/fast_node.h"
#endif

namespace prospect {
namespace {

ros::CameraInfo camera_info(const PinholeCamera& camera, double baseline) {
  ros::CameraInfo m;
  m.header.frame_id = "camera";
  m.width = static_cast<std::uint32_t>(camera.width);
  m.height = static_cast<std::uint32_t>(camera.height);
  m.k = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  m.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  m.p = {camera.fx, 0.0, camera.cx, -camera.fx * baseline, 0.0, camera.fy, camera.cy, 0.0, 0.0,
         0.0,       1.0, 0.0};
  return m;
}

template <typename Number>
ros::Image image_message(const ros::Header& header, int width, int height, const char* encoding,
                         const std::vector<Number>& pixels) {
  ros::Image m;
  m.header = header;
  m.width = static_cast<std::uint32_t>(width);
  m.height = static_cast<std::uint32_t>(height);
  m.encoding = encoding;
  m.step = m.width * static_cast<std::uint32_t>(sizeof(Number));
  m.data = {reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size() * sizeof(Number)};
  return m;
}

struct RobotOptions {
  DdsOptions topics;
  Configuration configuration;
  std::string world = "office";
  double seconds = 60.0;     // until it ends
  double image_rate = 10.0;  // of stereo pairs and depth images [Hz]
};

void print_truth(const KinematicRobot& body, const Pose& start, int stops) {
  const Pose at = body.pose();
  const Eigen::Rotation2Dd back(-start.yaw);
  const Eigen::Vector2d moved = back * (at.position - start.position).head<2>();
  std::printf(
      "way %.1f m, contacts %d, at (%.2f, %.2f) turned by %.2f rad, stopped by the dead-man "
      "%d times\n",
      body.path_length(), body.collisions(), moved.x(), moved.y(),
      std::remainder(at.yaw - start.yaw, 2.0 * M_PI), stops);
}

/// Node: DdsNode, or another with its declarations.
template <typename Node>
class Robot {
 public:
  Robot(const RobotOptions& options, Node& node)
      : options_(options),
        node_(node),
        world_(load_world(options.world, world_options_for(options.configuration))),
        rig_(make_rig()),
        start_(make_start()),
        body_(world_, options.configuration.robot.shape, {}, start_, 1),
        motors_(options.topics.command.dead_man) {
    const DdsOptions& topics = options.topics;
    left_ = node.template advertise<ros::Image>(topics.stereo.left, kSensorQos);
    right_ = node.template advertise<ros::Image>(topics.stereo.right, kSensorQos);
    depth_ = node.template advertise<ros::Image>(topics.depth.image, kSensorQos);
    left_info_ = node.template advertise<ros::CameraInfo>(topics.stereo.left_info, kSensorQos);
    right_info_ = node.template advertise<ros::CameraInfo>(topics.stereo.right_info, kSensorQos);
    depth_info_ = node.template advertise<ros::CameraInfo>(topics.depth.info, kSensorQos);
    odometry_ = node.template advertise<ros::Odometry>(topics.odometry, kReliableQos);
    node.template subscribe<ros::TwistStamped>(
        topics.command.stamped, kCommandQos,
        [this](const ros::TwistStamped& m) { motors_.command(m.twist); });
  }

  void run() {
    const double end = clock_.now() + options_.seconds;
    std::jthread motors([&] { drive(end); });
    see(end);
    motors.join();
    print_truth(body_, start_, motors_.stops());
  }

 private:
  CameraRig make_rig() const {
    const Configuration& c = options_.configuration;
    CameraRigOptions rig = c.simulator.camera.rig;
    rig.stereo = c.robot.stereo;
    rig.stereo_mount = c.robot.stereo_mount;
    rig.footprint = c.robot.depth;
    rig.depth_mount = c.robot.depth_mount;
    rig.depth_width = 320;
    rig.depth_height = 240;
    return CameraRig(std::make_shared<const SceneRenderer>(seen_mesh(world_, c.simulator)), rig);
  }
  Pose make_start() const {
    Pose start = world_.start;
    start.position.z() = options_.configuration.robot.base_height();
    return start;
  }

  // Motors and odometry at 50 Hz, beside the cameras.
  void drive(double end) {
    const auto& frames = options_.topics.frames;
    double before = clock_.now();
    Pose odom;
    while (clock_.now() < end) {
      clock_.wait_until(before + 0.02, {});
      const double now = clock_.now();
      const Twist command = motors_.now();
      Twist twist;
      {
        const std::lock_guard lock(mutex_);
        twist = twist_ = body_.move(command, now - before) ? command : Twist();
      }
      odom = advance(odom, twist, now - before);
      before = now;
      ros::Odometry m;
      m.header = {ros::time_of(now), frames.odom};
      m.child_frame_id = frames.base;
      m.pose.pose = ros::pose_message(odom);
      m.twist.twist.linear.x = twist.linear.x();
      m.twist.twist.angular.z = twist.yaw_rate;
      node_.publish(odometry_, m);
    }
  }

  void see(double end) {
    double next = clock_.now();
    for (std::uint64_t frame = 0; clock_.now() < end; ++frame) {
      Pose pose;
      Twist moving;
      {
        const std::lock_guard lock(mutex_);
        pose = body_.pose();
        moving = twist_;
      }
      const ros::Header header{ros::time_of(clock_.now()), "camera"};
      const ImagePair pair = rig_.stereo(pose, moving, frame);
      const DepthImage image = rig_.depth(pose, frame);
      const StereoCamera& stereo = rig_.options().stereo;
      node_.publish(left_info_, camera_info(stereo.left, 0.0));
      node_.publish(right_info_, camera_info(stereo.left, stereo.baseline));
      node_.publish(depth_info_, camera_info(rig_.depth_camera(), 0.0));
      const int width = pair.left.width, height = pair.left.height;
      node_.publish(left_, image_message(header, width, height, "mono8", pair.left.pixels));
      node_.publish(right_, image_message(header, width, height, "mono8", pair.right.pixels));
      node_.publish(depth_, image_message(header, image.width, image.height, "32FC1", image.depth));
      next = std::max(next + 1.0 / options_.image_rate, clock_.now());
      clock_.wait_until(next, {});
    }
  }

  const RobotOptions& options_;
  Node& node_;
  SteadyClock clock_;
  World world_;
  CameraRig rig_;
  Pose start_;
  std::mutex mutex_;  // of the body
  KinematicRobot body_;
  Twist twist_;
  test::DdsMotors motors_;
  int left_, right_, depth_, left_info_, right_info_, depth_info_, odometry_;
};

int drive_by_lidar(const RobotOptions& options, const DdsAddress& address) {
  const World world = load_world(options.world, world_options_for(options.configuration));
  test::DdsLidarRobot robot(world, options.configuration.robot, options.topics, address);
  const SteadyClock clock;
  clock.wait_until(clock.now() + options.seconds, {});
  robot.stop();
  print_truth(robot.body(), robot.start(), robot.motors().stops());
  return 0;
}

int run(int argc, char** argv) {
  std::string file, vendor = "cyclone";
  RobotOptions options;
  std::vector<std::string> settings;
  ProgramOptions program("A simulated robot behind topics of ROS 2");
  program.add("file", file, "With the robot's topics (YAML)", {.required = true});
  program.add("world", options.world, "Where it is");
  program.add("--seconds", options.seconds, "Until it ends [s]", {.least = 1.0, .most = 1e5});
  program.add("--image-rate", options.image_rate, "Of stereo pairs and depth images [Hz]",
              {.least = 0.5, .most = 60.0});
  program.add("--vendor", vendor, "CycloneDDS, or Fast DDS on this machine alone",
              {.one_of = {"cyclone", "fast"}});
  program.add("--set", settings, "A value of the configuration, KEY=VALUE");
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;

  options.topics = read_dds_options(file, ros_arguments());
  const Registries registries;
  options.configuration = read_configuration("", registries, {settings.begin(), settings.end()});
  DdsAddress address = options.topics.address;
  address.node = "robot";
  if (vendor == "fast") {
#ifdef PROSPECT_WITH_FASTDDS
    test::FastNode node(address);
    Robot robot(options, node);
    robot.run();
    return 0;
#else
    throw InputError("--vendor fast: Fast DDS is not installed (libfastrtps-dev)");
#endif
  }
  if (!options.topics.has_stereo()) return drive_by_lidar(options, address);
  DdsNode node(address);
  Robot robot(options, node);
  node.start();
  robot.run();
  for (const std::string& fault : node.faults()) std::printf("fault: %s\n", fault.c_str());
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("dds_robot", prospect::run, argc, argv);
}
