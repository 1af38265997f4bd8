// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>

#include "models/camera.h"
#include "models/types.h"
#include "perception/fusion/inertial_witness.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/mapping/scan_mapper.h"
#include "perception/odometry/stereo_odometry_options.h"
#include "perception/pipeline/feature_density.h"

namespace prospect {

class Knobs;

/// A depth camera on the body.
struct DepthCameraOnBody {
  PinholeCamera camera;
  CameraMount mount;
  std::optional<DepthRange>
      range{};  ///< that it believes; none: PerceptionOptions::depth_mapping's
};

/// How a robot perceives, whatever gives its images: its own cameras, a simulator's or a recording.
struct PerceptionOptions {
  CameraMount stereo_mount;                       ///< of the left camera, if there is one
  std::optional<DepthCameraOnBody> depth_camera;  ///< none: depth images are refused
  /// Depth cameras besides it, by the number of the depth sensor, from 1 on.
  std::map<int, DepthCameraOnBody> more_depth_cameras{};
  StereoOdometryOptions odometry;
  OccupancyMapperOptions mapping;    ///< of the one map
  DepthMapperOptions depth_mapping;  ///< how depth images enter it; its `map` is not used
  ScanMapperOptions scan_mapping;    ///< how scans do; its `map` is not used
  MoverTrackerOptions movers;        ///< how what moves is told from the building
  /// Wheels measure the motion. Without them poses are those of the odometry, held while it is
  /// lost.
  bool wheels = true;
  WheelFusionOptions wheel_fusion;  ///< its `start` is not used
  InertialOptions inertial;         ///< of an IMU beside cameras
  FeatureDensityOptions feature_density;
  /// Places that are seen again keep the map straight (straight_map.h), where this is built with
  /// Ceres: of a body in the plane whose pose is measured here. Of others it says nothing: poses
  /// from outside are for somebody else to correct.
  bool loops = true;
  /// Poses from outside are those of an odometry: in W, where they go on without a jump, each with
  /// its covariance from the start. Nobody else corrects them, so loops may; also of a body that is
  /// free in space, whose height and tilt are right.
  bool poses_drift = false;
  /// Of B in W, where the first pair is taken; z, the height of B's origin above the floor, is
  /// kept.
  Pose start;
  /// Radius [m] about the start within which somebody states that there is floor; 0: nobody does.
  double start_floor = 0.0;
  /// T_WB where the first pair is taken, of a body that is free in space: carried, flying, on
  /// uneven ground. Then `start` is not used, and wheels cannot measure the motion. None: the body
  /// moves in the plane.
  std::optional<Eigen::Isometry3d> start_in_space;

  /// Stamps nearer than this are of one time [s]: of a left and a right image, of a stereo pair and
  /// a depth image that are held against each other.
  double same_time = 0.005;
  /// What is older than the newest input of any source by more than this [s] is late and left out.
  double max_age = 1.0;
  /// What is newer than the newest input of any source by more than this [s] is of another clock,
  /// and refused. Infinite: a recording may rest for as long as it likes.
  double max_leap = 3600.0;
  /// A depth image or scan that is newer than the newest pose by more than this [s] waits for it.
  /// Up to then the robot is taken to go on as it does, or to stand if it has no wheels.
  double max_ahead = 0.02;
  /// Of a pose from outside, of which a point a metre ahead is off by a larger standard deviation
  /// [m]: it is degraded, or lost.
  double pose_degraded = 0.5, pose_lost = 1.0;
  int most_waiting = 8;  ///< depth images and scans that wait; beyond, the oldest is left out
};

/// The knobs (models/knobs.h). Cameras, their mounts and ranges and the heights of the body are
/// what the robot has; the start is where it stands.
void describe(Knobs& knobs, PerceptionOptions& options);

/// The map's options as its poses allow them: poses in the plane follow no ramp, in height or tilt,
/// so without start_in_space what rises stays an obstacle. This alone decides it.
OccupancyMapperOptions mapping_of(const PerceptionOptions& options);

}  // namespace prospect
