// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/simulator/camera_effects.h"
#include "adapters/robots/simulator/camera_rig_options.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/feature_camera.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "adapters/robots/simulator/landmark_builder.h"
#include "adapters/robots/simulator/odometry_model.h"
#include "adapters/robots/simulator/simulated_imu.h"
#include "adapters/robots/simulator/walkers.h"
#include "engine/maps/correction.h"
#include "models/camera.h"
#include "models/robot_description.h"
#include "models/robot_shape.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pipeline/perception_options.h"

namespace octomap {
class OcTree;
}

namespace prospect {

class Knobs;

/// How the robot of a simulation perceives.
enum class Sensors {
  kModel,   ///< odometry and landmarks as a model of their errors (FeatureSensors): fast
  kCamera,  ///< rendered images through this project's perception (CameraSensors)
};

/// What the second of them needs besides.
struct CameraSensorsOptions {
  /// Cameras and mounts are set from the simulator's, depth noise from its depth camera, effects
  /// from those below.
  CameraRigOptions rig;
  /// Of the effects' size: 0 ideal cameras in an empty world, 1 as real ones.
  double realism = 1.0;
  CameraEffects effects;
  /// Contrast of all surfaces: 1 rich, 0 blank.
  double texture_quality = 1.0;
  /// Share by which the robot takes its stereo pair's focal length and baseline to be larger than
  /// they are: a calibration that is wrong.
  double focal_error = 0.0, baseline_error = 0.0;
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, CameraSensorsOptions& options);

/// How the wheels of a robot with cameras really err: as the reckoning in OdometryOptions does. The
/// scales are drawn once.
constexpr WheelNoise kSimulatedWheels{
    .along = 0.02, .across = 0.01, .turn = 0.01, .heading = 0.005, .sigma_scale = 0.01};

/// A correction of the map's frame that somebody makes at `time` [s] (correction.h): a place that
/// was at p is at R(yaw) p + (x, y) [m], [rad] then.
struct ScheduledCorrection {
  double time = 0.0, x = 0.0, y = 0.0, yaw = 0.0;
  CorrectionKind kind = CorrectionKind::kMap;  ///< kRobot: of its place in what it has drawn, in W
};

/// Everything a simulated mission depends on besides its world, the robot's perception and the
/// commands.
struct SimulatorOptions {
  std::uint64_t seed = 1;
  Sensors sensors = Sensors::kModel;

  RobotShape shape = CylinderShape{};
  double base_height = 0.0;  ///< of B's origin above the floor [m]: RobotDescription::base_height()
  ActuationNoise actuation;  ///< none by default: commands are executed exactly

  CameraMount depth_mount;
  DepthCameraOptions depth;
  double depth_rate = 5.0;  ///< [Hz]
  /// RobotDescription::more_depth; noise and spacing of their rays are those of `depth`.
  std::vector<DepthSensor> more_depth{};

  CameraMount stereo_mount;
  FeatureCameraOptions features;
  double image_rate = 10.0;  ///< [Hz]: tracking of features; keyframes are taken among these images

  OdometryOptions odometry;
  LandmarkBuilderOptions landmarks;  ///< density is that of the robot's perception
  WheelNoise wheels = kSimulatedWheels;
  SimulatedImuOptions imu;

  /// A map of the same world to begin with, in W (OccupancyMapper::load); null: none. What it knows
  /// counts as seen, if it is known where in it the robot starts; else the robot looks for its
  /// place (straight_map.h).
  std::shared_ptr<const octomap::OcTree> map{};
  bool place_known = true;

  CameraSensorsOptions camera;
  WalkersOptions walkers;                          ///< besides those of camera.effects
  std::vector<ScheduledCorrection> corrections{};  ///< by time
  /// Somebody carries the robot to a place on the floor, in the world's frame, at `time` [s]: it
  /// notices that, and does not know where it is then. By time.
  struct Carried {
    double time = 0.0;
    Pose to;
  };
  std::vector<Carried> carried{};
};

/// The knobs (models/knobs.h): all that does not come from the robot, the world or the command
/// line.
void describe(Knobs& knobs, SimulatorOptions& options);

/// How the robot of a simulation perceives unless it is told otherwise: its fusion knows how the
/// wheels err, and its odometry how far the calibration of the cameras may be off, where that is
/// more than usual. Inputs come at once, so none waits for a pose (max_ahead).
PerceptionOptions simulated_perception(const SimulatorOptions& options = {});

/// `mapping`, with what it takes from the robot: slice is body_slice() of shape and base_height,
/// max_range the longest of the depth sensors.
OccupancyMapperOptions mapping_options(const SimulatorOptions& options,
                                       OccupancyMapperOptions mapping);
/// What of robot and map does not fit together (range_misfit(), layers_misfit()): "" or the keys,
/// the numbers, and what would fit. The Simulator's constructor asks it, and so does every mission
/// before it begins.
std::string simulator_misfit(const SimulatorOptions& options,
                             const OccupancyMapperOptions& mapping);

}  // namespace prospect
