// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/make_robot.h"

#include <memory>
#include <optional>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_clock.h"
#include "adapters/robots/dds/dds_commands.h"
#include "adapters/robots/dds/dds_navigation.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_pose.h"
#include "adapters/robots/dds/dds_publisher.h"
#include "adapters/robots/dds/dds_sensors.h"
#include "adapters/robots/dds/dds_transforms.h"
#include "adapters/robots/dds/robot_with_cameras.h"
#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_frames.h"

namespace prospect {
namespace {

/// Stamps of topics that a simulation tells the time of are those of the clock.
SensorInboxOptions inbox_options(const DdsRobotConfiguration& o) {
  return o.topics.use_sim_time ? in_runtime_clock(o.inbox) : o.inbox;
}

/// All that the robot's pointers share. The node's thread ends first.
struct DdsParts {
  explicit DdsParts(const DdsRobotConfiguration& o)
      : simulation(o.topics.use_sim_time ? std::make_unique<const DdsClock>(
                                               o.topics.address, o.topics.clock, o.topics.timeout)
                                         : nullptr),
        requests(o.requests ? *o.requests : own_requests),
        clock(simulation ? simulation->clock() : machine),
        start(clock.now()),
        inbox(clock, FaultyFrames::inbox_options(inbox_options(o), o.faults)),
        frames(clock, inbox, o.faults, start, {o.topics.depth.min_range, o.topics.depth.max_range}),
        node(o.topics.address),
        transforms(node, o.topics.tf, o.topics.tf_static),
        base(o.topics, node, transforms, clock, o.requests, o.inbox.pose_jump),
        faulty_base(base, clock, o.faults, start),
        sensors(o.topics, node, transforms, frames),
        publisher(o.topics, node, base, clock, o.robot.model, requests),
        commands(o.topics, node, transforms, requests),
        navigation(o.topics, node, transforms, base, clock, requests) {
    if (o.topics.is_told_its_pose()) pose.emplace(o.topics, node, transforms, frames, &base);
    node.start();
  }
  ~DdsParts() { node.stop(); }

  const SteadyClock machine;
  const std::unique_ptr<const DdsClock> simulation;  // null: time is the machine's
  DriveRequests own_requests;                        // of who gives none, and reads none
  DriveRequests& requests;
  const Clock& clock;
  const double start;  // [s] of the faults
  SensorInbox inbox;
  FaultyFrames frames;
  DdsNode node;
  DdsTransforms transforms;
  DdsBase base;
  FaultyBase faulty_base;
  const DdsSensors sensors;
  std::optional<DdsPose> pose;  // none: it localizes itself, by cameras or wheels
  DdsPublisher publisher;
  const DdsCommands commands;
  DdsNavigation navigation;
};

}  // namespace

Robot make_robot(const DdsRobotConfiguration& options) {
  if (options.robot.more_depth.size() != options.topics.more_depth.size()) {
    throw InputError("robot.more_depth: " + std::to_string(options.robot.more_depth.size()) +
                     " depth sensors, the topics have " +
                     std::to_string(options.topics.more_depth.size()) +
                     "; expected one for each entry of more_depth there, in the same order");
  }
  const auto parts = std::make_shared<DdsParts>(options);
  const DdsCameras cameras = parts->sensors.wait();
  if (const auto faults = parts->base.report().faults; !faults.empty()) throw InputError(faults);
  Robot robot;
  robot.name = "dds";
  robot.clock = {parts, &parts->clock};
  robot.base = {parts, &parts->faulty_base};
  robot.frames = {parts, &parts->inbox};
  robot.streams = {cameras.depth ? SensorStream::kDepth : SensorStream::kScan};
  if (!options.topics.odometry.empty()) robot.streams.push_back(SensorStream::kWheels);
  if (!options.topics.imu.empty()) robot.streams.push_back(SensorStream::kImu);
  if (parts->pose) robot.streams.insert(robot.streams.begin(), SensorStream::kPose);
  if (cameras.stereo) robot.streams.insert(robot.streams.begin(), SensorStream::kPair);
  if (parts->pose) robot.start = parts->pose->wait();
  robot.start.position.z() = options.robot.base_height();
  robot.made = parts->start;
  robot.simulated_time = options.topics.use_sim_time;
  robot.depth = cameras.depth;
  robot.more_depth = cameras.more_depth;
  if (cameras.stereo || cameras.depth || cameras.lidar || !cameras.more_depth.empty() ||
      !cameras.more_lidars.empty()) {
    robot.description = robot_with(cameras, options.robot);
    robot.described_by = "the robot's topics";
  }
  robot.emergency_stop = parts->base.emergency_stop();
  robot.observers = {&parts->publisher, &parts->navigation};
  robot.link_faults = [parts] { return parts->node.faults(); };
  return robot;
}

}  // namespace prospect
