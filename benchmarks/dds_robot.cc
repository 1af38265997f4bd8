// A simulated robot behind topics of ROS 2, as `prospect drive --base dds` meets a real one: stereo
// images, depth images and their calibrations, odometry; it takes velocity commands, and stops by
// itself when they cease. Over loopback.
//
//   dds_robot FILE.yaml [WORLD] [--seconds T] [--image-rate HZ] [--set KEY=VALUE]...
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

#include "adapters/config/configuration.h"
#include "adapters/config/registries.h"
#include "adapters/dds/dds_node.h"
#include "adapters/dds/dds_options.h"
#include "adapters/ros/geometry_msgs.h"
#include "adapters/ros/nav_msgs.h"
#include "adapters/ros/sensor_msgs.h"
#include "adapters/run/exploration_run.h"
#include "adapters/simulator/camera_rig.h"
#include "adapters/simulator/camera_sensors.h"
#include "adapters/simulator/kinematic_robot.h"
#include "adapters/simulator/scene_renderer.h"
#include "adapters/worlds/load_world.h"
#include "benchmarks/guarded_main.h"
#include "benchmarks/program_options.h"
#include "runtime/clock.h"

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

/// The motors: what was commanded last, until it is too old.
class Motors {
 public:
  explicit Motors(double dead_man) : dead_man_(dead_man) {}
  void command(const ros::Twist& twist) {
    const std::lock_guard lock(mutex_);
    command_ = {{twist.linear.x, twist.linear.y, 0.0}, twist.angular.z};
    newest_ = clock_.now();
  }
  Twist now() {
    const std::lock_guard lock(mutex_);
    if (clock_.now() - newest_ < dead_man_) return command_;
    stops_ += command_.linear.norm() + std::abs(command_.yaw_rate) > 0.0;
    command_ = {};
    return command_;
  }
  int stops() const { return stops_; }

 private:
  SteadyClock clock_;
  double dead_man_;
  std::mutex mutex_;
  Twist command_;
  double newest_ = -1e9;
  int stops_ = 0;
};

int run(int argc, char** argv) {
  std::string file, world_name = "office";
  double seconds = 60.0, image_rate = 10.0;
  std::vector<std::string> settings;
  ProgramOptions program("A simulated robot behind topics of ROS 2");
  program.add("file", file, "With the robot's topics (YAML)", {.required = true});
  program.add("world", world_name, "Where it is");
  program.add("--seconds", seconds, "Until it ends [s]", {.least = 1.0, .most = 1e5});
  program.add("--image-rate", image_rate, "Of stereo pairs and depth images [Hz]",
              {.least = 0.5, .most = 60.0});
  program.add("--set", settings, "A value of the configuration, KEY=VALUE");
  if (const std::optional<int> code = program.parse(argc, argv)) return *code;

  const DdsOptions topics = read_dds_options(file);
  const Registries registries;
  const Configuration c = read_configuration("", registries, settings);
  const World world = load_world(world_name, world_options_for(c));
  CameraRigOptions rig_options = c.simulator.camera.rig;
  rig_options.stereo = c.robot.stereo;
  rig_options.stereo_mount = c.robot.stereo_mount;
  rig_options.footprint = c.robot.depth;
  rig_options.depth_mount = c.robot.depth_mount;
  rig_options.depth_width = 320;
  rig_options.depth_height = 240;
  const CameraRig rig(std::make_shared<const SceneRenderer>(seen_mesh(world, c.simulator)),
                      rig_options);
  Pose start = world.start;
  start.position.z() = c.robot.base_height();
  KinematicRobot robot(world, c.robot.shape, {}, start, 1);

  Motors motors(topics.command.dead_man);
  DdsAddress address = topics.address;
  address.node = "robot";
  DdsNode node(address);
  const auto& s = topics.stereo;
  const int left = node.advertise<ros::Image>(s.left, kSensorQos);
  const int right = node.advertise<ros::Image>(s.right, kSensorQos);
  const int depth = node.advertise<ros::Image>(topics.depth.image, kSensorQos);
  const int left_info = node.advertise<ros::CameraInfo>(s.left_info, kSensorQos);
  const int right_info = node.advertise<ros::CameraInfo>(s.right_info, kSensorQos);
  const int depth_info = node.advertise<ros::CameraInfo>(topics.depth.info, kSensorQos);
  const int odometry = node.advertise<ros::Odometry>(topics.odometry, kReliableQos);
  node.subscribe<ros::TwistStamped>(topics.command.stamped, kCommandQos,
                                    [&](const ros::TwistStamped& m) { motors.command(m.twist); });
  node.start();

  const SteadyClock clock;
  const double begin = clock.now(), end = begin + seconds;
  std::mutex mutex;  // of the body
  Twist twist;
  // Motors and odometry at 50 Hz, beside the cameras.
  std::jthread drives([&] {
    double before = clock.now();
    Pose odom;
    while (clock.now() < end) {
      clock.wait_until(before + 0.02, {});
      const double now = clock.now();
      const Twist command = motors.now();
      {
        const std::lock_guard lock(mutex);
        twist = robot.move(command, now - before) ? command : Twist();
      }
      odom = advance(odom, twist, now - before);
      before = now;
      ros::Odometry m;
      m.header = {ros::time_of(now), topics.frames.odom};
      m.child_frame_id = topics.frames.base;
      m.pose.pose.position = {odom.position.x(), odom.position.y(), 0.0};
      m.pose.pose.orientation = {0.0, 0.0, std::sin(0.5 * odom.yaw), std::cos(0.5 * odom.yaw)};
      m.twist.twist.linear.x = twist.linear.x();
      m.twist.twist.angular.z = twist.yaw_rate;
      node.publish(odometry, m);
    }
  });
  double next = begin;
  for (std::uint64_t frame = 0; clock.now() < end; ++frame) {
    Pose pose;
    Twist moving;
    {
      const std::lock_guard lock(mutex);
      pose = robot.pose();
      moving = twist;
    }
    const ros::Header header{ros::time_of(clock.now()), "camera"};
    const ImagePair pair = rig.stereo(pose, moving, frame);
    const DepthImage image = rig.depth(pose, frame);
    node.publish(left_info, camera_info(rig.options().stereo.left, 0.0));
    node.publish(right_info, camera_info(rig.options().stereo.left, rig.options().stereo.baseline));
    node.publish(depth_info, camera_info(rig.depth_camera(), 0.0));
    const int width = pair.left.width, height = pair.left.height;
    node.publish(left, image_message(header, width, height, "mono8", pair.left.pixels));
    node.publish(right, image_message(header, width, height, "mono8", pair.right.pixels));
    node.publish(depth, image_message(header, image.width, image.height, "32FC1", image.depth));
    next = std::max(next + 1.0 / image_rate, clock.now());
    clock.wait_until(next, {});
  }
  drives.join();
  const Pose at = robot.pose();
  const Eigen::Rotation2Dd back(-start.yaw);
  const Eigen::Vector2d moved = back * (at.position - start.position).head<2>();
  std::printf(
      "way %.1f m, contacts %d, at (%.2f, %.2f) turned by %.2f rad, stopped by the dead-man "
      "%d times\n",
      robot.path_length(), robot.collisions(), moved.x(), moved.y(),
      std::remainder(at.yaw - start.yaw, 2.0 * M_PI), motors.stops());
  for (const std::string& fault : node.faults()) std::printf("fault: %s\n", fault.c_str());
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  return prospect::guarded_main("dds_robot", prospect::run, argc, argv);
}
