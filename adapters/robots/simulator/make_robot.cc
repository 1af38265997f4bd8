// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/make_robot.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "adapters/robots/faults/faulty_base.h"
#include "adapters/robots/faults/faulty_frames.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulated_streams.h"

namespace prospect {
namespace {

/// The depth camera of the tier: that of the images, or one for the rays of a scan. None: what it
/// sees is no image in perspective.
std::optional<PinholeCamera> camera_of(const SimulatedRobotConfiguration& options) {
  const RgbdFootprint& seen = options.robot.depth;
  if (std::max(seen.horizontal_fov, seen.vertical_fov) >= M_PI) return std::nullopt;
  const SimulatorOptions& simulator = options.simulator;
  const CameraRigOptions& rig = simulator.camera.rig;
  const bool images = simulator.sensors == Sensors::kCamera;
  // Rays of a scan lie between pixels, by less in a finer image.
  constexpr int kFiner = 4;
  return depth_camera(seen, images ? rig.depth_width : kFiner * simulator.depth.columns,
                      images ? rig.depth_height : kFiner * simulator.depth.rows);
}

/// Of the depth sensors from 1 on those with images, as CameraSensors renders them.
std::map<int, PinholeCamera> more_cameras_of(const SimulatedRobotConfiguration& options) {
  std::map<int, PinholeCamera> cameras;
  const CameraRigOptions& rig = options.simulator.camera.rig;
  if (options.simulator.sensors != Sensors::kCamera) return cameras;
  int number = 0;
  for (const DepthSensor& sensor : options.simulator.more_depth) {
    ++number;
    if (!is_rendered(sensor.footprint)) continue;
    cameras[number] = depth_camera(sensor.footprint, rig.depth_width, rig.depth_height);
  }
  return cameras;
}

/// All that the robot's pointers share.
struct SimulatedParts {
  explicit SimulatedParts(const SimulatedRobotConfiguration& o)
      : clock(o.clock),
        simulator(o.world, o.simulator, o.perception),
        base(simulator, *clock, *o.robot.model, o.base),
        faulty_base(base, *clock, o.faults, base.start()),
        inbox(*clock, FaultyFrames::inbox_options(simulated_inbox(o.inbox), o.faults)),
        frames(*clock, inbox, o.faults, base.start(),
               {o.robot.depth.min_range, o.robot.depth.max_range}),
        beliefs(base, simulator, *clock, inbox, frames, o.base.belief_period) {}

  const std::shared_ptr<const Clock> clock;
  Simulator simulator;
  SimulatedBase base;
  FaultyBase faulty_base;
  SensorInbox inbox;
  FaultyFrames frames;
  SimulatedStreams beliefs;
};

}  // namespace

Robot make_robot(const SimulatedRobotConfiguration& options) {
  const auto parts = std::make_shared<SimulatedParts>(options);
  parts->simulator.set_reachable(options.reachable);
  Robot robot;
  robot.name = options.world->name;
  robot.clock = parts->clock;
  robot.base = {parts, &parts->faulty_base};
  robot.frames = {parts, &parts->inbox};
  robot.beliefs = {parts, &parts->beliefs};
  if (options.simulator.imu.rate > 0.0) robot.streams = {SensorStream::kImu};
  robot.truth = {parts, &parts->base};
  robot.start = parts->simulator.true_pose();
  robot.made = parts->base.start();
  robot.depth = camera_of(options);
  robot.more_depth = more_cameras_of(options);
  return robot;
}

SimulatedLockstep::SimulatedLockstep(const SimulatedRobotConfiguration& options)
    : simulator_(options.world, options.simulator, options.perception) {
  simulator_.set_reachable(options.reachable);
}

void SimulatedLockstep::watched_by(std::vector<MissionObserver*> observers) {
  observers_ = std::move(observers);
  simulator_.deliver_to(this);
}

TrueState SimulatedLockstep::newest() const { return truth_of(simulator_); }

void SimulatedLockstep::observe(const SensorFrame& frame) {
  tell(observers_, &MissionObserver::on_frame, frame);
}

}  // namespace prospect
