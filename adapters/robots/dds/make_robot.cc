#include "adapters/robots/dds/make_robot.h"

#include <memory>
#include <optional>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_pose.h"
#include "adapters/robots/dds/dds_publisher.h"
#include "adapters/robots/dds/dds_sensors.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "adapters/robots/dds/robot_with_cameras.h"

namespace prospect {
namespace {

/// All that the robot's pointers share. The node's thread ends after what has handlers in it.
struct DdsParts {
  explicit DdsParts(const DdsRobotConfiguration& o)
      : inbox(clock, o.inbox),
        node(o.topics.address),
        transforms(node, o.topics.tf, o.topics.tf_static),
        base(o.topics, node, transforms, clock, o.requests),
        sensors(o.topics, node, transforms, inbox),
        publisher(o.topics, node, base, clock, o.robot.model) {
    if (o.topics.is_told_its_pose()) pose.emplace(o.topics, node, transforms, inbox);
    node.start();
  }

  const SteadyClock clock;
  SensorInbox inbox;
  DdsNode node;
  DdsTransforms transforms;
  DdsBase base;
  const DdsSensors sensors;
  std::optional<DdsPose> pose;  // none: it localizes itself, by cameras or wheels
  DdsPublisher publisher;
};

}  // namespace

Robot make_robot(const DdsRobotConfiguration& options) {
  const auto parts = std::make_shared<DdsParts>(options);
  const DdsCameras cameras = parts->sensors.wait();
  if (const auto faults = parts->base.report().faults; !faults.empty()) throw InputError(faults);
  Robot robot;
  robot.name = "dds";
  robot.clock = {parts, &parts->clock};
  robot.base = {parts, &parts->base};
  robot.frames = {parts, &parts->inbox};
  robot.streams = {cameras.depth ? SensorStream::kDepth : SensorStream::kScan,
                   SensorStream::kWheels};
  if (parts->pose) robot.streams.insert(robot.streams.begin(), SensorStream::kPose);
  if (cameras.stereo) robot.streams.insert(robot.streams.begin(), SensorStream::kPair);
  if (parts->pose) robot.start = parts->pose->wait();
  robot.start.position.z() = options.robot.base_height();
  robot.made = parts->clock.now();
  robot.depth = cameras.depth;
  if (cameras.stereo || cameras.depth || cameras.lidar) {
    robot.description = robot_with(cameras, options.robot);
    robot.described_by = "the robot's topics";
  }
  robot.emergency_stop = parts->base.emergency_stop();
  robot.observers = {&parts->publisher};
  robot.link_faults = [parts] { return parts->node.faults(); };
  return robot;
}

}  // namespace prospect
