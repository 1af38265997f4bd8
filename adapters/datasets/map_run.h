#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/datasets/depth_dataset.h"
#include "adapters/datasets/time_percentiles.h"
#include "adapters/datasets/wall_thickness.h"
#include "perception/mapping/depth_mapper.h"

namespace prospect {

struct MapRunOptions {
  DepthMapperOptions mapper;
  /// What is known of the camera before the first image. The default is wide: carried or on a
  /// robot, 0.2 to 2 m high, pitched up by 15 to down by 55 degrees.
  GroundPrior prior = ground_prior(1.1, 0.35, 0.0, 0.9, 0.61);
  /// The ground of the first so many frames that show it says where the floor is.
  int first_frames = 10;
  /// Without poses: how far the ground of a frame may be from that of the first ones.
  double tilt_tolerance = 0.15;   ///< [rad]
  double height_tolerance = 0.1;  ///< [m]
};

/// One frame of a run. With poses, `up` and `height_error` are in W: the measured normal, and the
/// measured height less that of the pose. Without, `up` is the normal in C.
struct MapRunFrame {
  MappedFrame mapped;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double height_error = 0.0;  ///< [m]; NaN without poses
  double snapshot = 0.0;  ///< processor time to bring octree, voxels and ground map up to date [ms]
};

/// A hypothesis of the ground as it stood after one frame.
struct GroundRecord {
  int frame = 0;              ///< index in MapRun::frames
  double stamp = 0.0;         ///< of the frame [s]
  int hypothesis = 0;         ///< numbered from 0 as they were first seen
  double height = 0.0;        ///< of the run's first camera above it [m]
  double pitch = 0.0;         ///< of that camera, down [rad]
  double roll = 0.0;          ///< of that camera, the image's right side down [rad]
  double sigma_height = 0.0;  ///< standard deviation [m]
  double sigma_tilt = 0.0;    ///< largest standard deviation of its normal's direction [rad]
  int support = 0;            ///< frames that have shown it so far
  bool taken = false;         ///< W's floor; at most one hypothesis of a frame
  std::string why;            ///< why it is taken, or why not
};

/// What one pass of the mapper over a recording gives.
struct MapRun {
  std::vector<MapRunFrame> frames;
  /// The ground over time: of each frame its hypotheses, by frame, then by number.
  std::vector<GroundRecord> ground;
  /// W from the recording's world: z up, floor at z = 0, origin below the first camera, which looks
  /// along +x. Identity without poses.
  Eigen::Isometry3d T_WD = Eigen::Isometry3d::Identity();
  GroundPrior first;  ///< the ground of the first frames, as the first camera would see it
  BeliefMaps maps;    ///< null without poses: nothing is mapped
};

/// Runs the mapper over a recording, from frame `first`, at most `max_frames` (0: all).
///
/// The recording's world points anywhere, so the floor is found first: of the ground planes in the
/// first frames that show one (find_ground() with `prior`), all in the recording's world, the one
/// with the least sum of distances to the others (angle / 0.02 rad + height / 0.02 m) is W's floor.
/// Without poses that is done in the camera's frame, and then the ground of each frame is measured,
/// but nothing is mapped.
///
/// Throws InputError if no frame shows the ground, or an image cannot be read. `progress`, if
/// any, is called after each frame with the number done. One thread; the same recording gives the
/// same bits, but for times.
MapRun run_mapping(const DepthDataset& dataset, const MapRunOptions& options = {}, int first = 0,
                   int max_frames = 0,
                   const std::function<void(int, const MapRunFrame&)>& progress = {});

/// Counts and spreads of a run; NaN where there is nothing to measure.
struct MapSummary {
  int frames = 0, ok = 0, degraded = 0, rejected = 0;
  std::string rejected_reason;  ///< the most frequent one; empty if no frame was rejected
  int ground = 0;               ///< frames in which it was found
  double height_median = 0.0;   ///< of the camera above the ground [m]
  double height_min = 0.0, height_max = 0.0;
  /// With poses: root mean square of (measured height - that of the pose) [m].
  double height_error = 0.0;
  /// Root mean square and largest angle between a frame's normal and the mean one [rad]: in W with
  /// poses, in C without.
  double tilt_spread = 0.0, tilt_worst = 0.0;
  int free_cells = 0, occupied_cells = 0;  ///< of the ground map
  /// Occupied cells with nothing occupied higher than 0.2 m in them or beside them: low things, and
  /// what a floor that was taken for an obstacle would look like.
  int low_cells = 0;
  WallThickness walls;
  /// Processor times [ms]; `frame` is all of it.
  TimePercentiles check, ground_plane, scan, insert, snapshot, frame;
};
MapSummary summarize(const MapRun& run);

/// One row a frame: number, stamp, state, reason, ground plane, pose entered, rays. No times, so
/// the same recording gives the same bytes.
std::string ground_csv(const MapRun& run);

}  // namespace prospect
