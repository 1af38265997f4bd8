// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "engine/maps/ground_map.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/localization.h"
#include "engine/maps/movers.h"
#include "engine/maps/voxel_grid.h"
#include "models/types.h"

namespace octomap {
class OcTree;
}

namespace prospect {

struct MapFrame;

/// When the sources of a belief last had their say [s], in the clock of Belief::stamp. Whoever
/// publishes a belief sets each of them: the guard refuses what is older than its limits, so that
/// nothing that has stopped hides behind what goes on (guard.h). 0 is what a source has that was
/// forgotten.
struct SourceStamps {
  double pose = 0.0;       ///< newest measurement that the pose takes in, of cameras or wheels
  double map = 0.0;        ///< newest scan that the maps have taken in
  double landmarks = 0.0;  ///< newest image in which landmarks were looked for
  double ranges = 0.0;     ///< newest scan that the depth sensor delivered
};

/// What the estimate of the pose rests on.
enum class LocalizationSource {
  kVisualOdometry,  ///< points tracked by the robot's cameras: the planner keeps enough in view
  kExternal         ///< something else, such as a lidar in a known map: features are of no use
};

/// What the planner knows at one instant: an immutable snapshot, published by perception as
/// shared_ptr<const Belief>. The maps are shared, never null (landmarks may be, with kExternal),
/// and never change after publication, so a solve cannot see a half-updated map. The octree is
/// authoritative; voxels and ground are derived from it and carry its resolution.
///
/// Frames: everything in W, in which odometry goes on without a jump (it drifts against the true
/// world). What people told the robot is in the map's frame, which may move in W: map_frame.
struct Belief {
  double stamp = 0.0;  ///< [s], from the clock passed to perception
  SourceStamps stamps;
  Pose pose;
  Eigen::Matrix4d covariance =
      Eigen::Matrix4d::Zero();  ///< of pose's error in (x, y, z, yaw) with its correlations, from
                                ///< the start of the mission; zero: exact. Its growth tells how far
                                ///< what was not seen for long may be off (surface_drift.h). One
                                ///< that is not finite or not positive semi-definite is no
                                ///< covariance and bounds nothing (pose_error.h)
  Twist twist;                  ///< estimated body velocity
  /// The command in force, if whoever publishes knows it: rates are limited from there. Without it
  /// the estimated velocity stands for it, whose noise a limit on rates does not forgive, and it
  /// goes unnoticed that the robot does not follow (following_monitor.h). Zero while something
  /// else, such as an emergency stop, keeps the robot from following it.
  std::optional<Twist> command;
  Localization localization = Localization::kOk;
  /// With kExternal, landmarks and tracked_features are not used: features cost nothing and take no
  /// time. `localization` counts as ever.
  LocalizationSource localization_source = LocalizationSource::kVisualOdometry;
  int tracked_features = 0;  ///< points tracked in the newest image

  std::shared_ptr<const octomap::OcTree> octree;
  std::shared_ptr<const VoxelGrid> voxels;
  std::shared_ptr<const GroundMap> ground;
  std::shared_ptr<const LandmarkMap> landmarks;

  /// What moves by itself, which the maps leave out; null: nothing is known to.
  std::shared_ptr<const Movers> movers{};

  /// Where W lies in the map's frame, as corrected so far (correction.h). Null: they are the same,
  /// and nobody says otherwise.
  std::shared_ptr<const MapFrame> map_frame{};

  /// Everything is of time t [s].
  void set_stamps(double t) {
    stamp = t;
    stamps = {t, t, t, t};
  }
};

}  // namespace prospect
