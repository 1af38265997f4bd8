#include "adapters/missions/run/dds_run.h"

#include <octomap/OcTree.h>

#include <memory>
#include <optional>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/run/live_mission.h"
#include "adapters/missions/run/live_perception.h"
#include "adapters/missions/run/run_recorder.h"
#include "adapters/missions/run/unmeasured.h"
#include "adapters/robots/dds/camera_settings.h"
#include "adapters/robots/dds/dds_base.h"
#include "adapters/robots/dds/dds_node.h"
#include "adapters/robots/dds/dds_publisher.h"
#include "adapters/robots/dds/dds_sensors.h"
#include "engine/planner/planner.h"
#include "engine/planner/planner_guard.h"
#include "models/reason.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/range_check.h"
#include "runtime/range_stop.h"

namespace prospect {
ExplorationRunResult explore_dds(const Configuration& given, const DdsOptions& topics,
                                 const ExplorationRunOptions& options) {
  Configuration c = given;
  check_drives(c);
  const SteadyClock clock;
  SensorInbox inbox(clock, c.drive.inbox);
  DdsNode node(topics.address);
  DdsTransforms transforms(node, topics.tf, topics.tf_static);
  DdsBase base(topics, node, transforms, clock, options.requests);
  const DdsSensors sensors(topics, node, transforms, inbox);
  DdsPublisher publisher(topics, node, base, clock, c.robot.model);
  node.start();
  const DdsCameras cameras = sensors.wait();
  if (const auto faults = base.report().faults; !faults.empty()) throw InputError(faults);
  set_robot(c, camera_settings(cameras), "the topics of the cameras:");
  const std::unique_ptr<Replanner> planner = planner_for(c, options);

  Pose start;
  start.position.z() = c.robot.base_height();
  std::optional<RangeCamera> depth;
  if (cameras.depth) {
    depth = {
        *cameras.depth, c.robot.depth_mount, {c.robot.depth.min_range, c.robot.depth.max_range}};
  }
  PerceptionPipeline perception(c.robot.stereo, live_perception(c, depth, start));
  clear_start(perception.map(), c, start);
  PictureTap pictures(options.taps, perception);
  PipelineBeliefs beliefs(inbox, perception, pictures.frames());
  const Guard guard = guard_for(c.robot, c.planner, c.guard);
  const RangeStop stop(c.drive.ranges);

  LiveRobot robot{
      .clock = clock,
      .base = base,
      .beliefs = beliefs,
      .planner = *planner,
      .guard = guard,
      .inbox = &inbox,
      .streams = {watched(inbox, SensorStream::kPair, "cameras", c.guard.max_pose_age),
                  depth ? watched(inbox, SensorStream::kDepth, "depth", c.guard.max_ranges_age)
                        : watched(inbox, SensorStream::kScan, "scan", c.guard.max_ranges_age),
                  watched(inbox, SensorStream::kWheels, "wheels", c.guard.max_pose_age)},
      // Without a depth camera there are no depth images, and its numbers are not looked at.
      .ranges = range_check(inbox, stop, depth.value_or(RangeCamera{})),
      .emergency_stop = base.emergency_stop(),
      .on_perceived = pictures.perceived()};
  if (depth) robot.floor = newest_floor(inbox, *depth, c.robot.base_height());
  RunRecorder recorder(c, options, dynamic_cast<const Planner*>(planner.get()));
  if (options.on_start) options.on_start(c);
  ExplorationRunResult result;
  Unmeasured unmeasured;
  const auto observe = [&](const MissionStep& step) {
    publisher.publish(step);
    recorder.add(step, unmeasured.at(step));
  };
  const MissionResult mission =
      live_mission(robot, c, mission_options_for(c, [&] { return unmeasured.truth(); }), observe,
                   options, result);
  result.record = recorder.finish(mission, "dds", unmeasured.truth(), nullptr);
  result.record.summary.measured = false;
  result.map = perception.belief()->octree;
  result.complaint = perception.complaint();
  for (const std::string& fault : node.faults()) add_reason(result.complaint, fault);
  return result;
}

}  // namespace prospect
