// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/datasets/depth_dataset.h"
#include "adapters/missions/recordings/time_percentiles.h"
#include "adapters/missions/recordings/wall_thickness.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/mapping/ground_hypotheses.h"
#include "perception/mapping/mover_tracker.h"

namespace prospect {

struct MapRunOptions {
  DepthMapperOptions mapper;
  /// What is known of the camera before the first image. The default is wide: carried or on a
  /// robot, 0.2 to 2 m high, pitched up by 15 to down by 55 degrees.
  GroundPrior prior = ground_prior(1.1, 0.35, 0.0, 0.9, 0.61);
  /// Height of the first camera above the ground as it was stated [m], and its standard deviation
  /// [m]; none: not known.
  std::optional<double> height;
  double sigma_height = 0.05;
  /// Without poses: how far the ground of a frame may be from that of the first ones.
  double tilt_tolerance = 0.15;   ///< [rad]
  double height_tolerance = 0.1;  ///< [m]
  /// The poses drift, and places that are seen again correct them; needs poses and Ceres.
  bool loops = false;
  MoverTrackerOptions movers{};
};

/// One frame of a run. With poses, `up` and `height_error` are in W: the measured normal, and the
/// measured height less that of the pose. Without, `up` is the normal in C.
struct MapRunFrame {
  MappedFrame mapped;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double height_error = 0.0;  ///< [m]; NaN without poses
  double hypotheses = 0.0;    ///< processor time of the hypotheses of the ground [ms]
  double snapshot = 0.0;  ///< processor time to bring octree, voxels and ground map up to date [ms]
  int anchor = 0;         ///< with loops: what it was seen from (MapAnchor::id)
};

/// What loops have done to a run.
struct MapRunLoops {
  int found = 0, used = 0;
  double farthest = 0.0;  ///< [m] that a pose was moved, at most
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

/// When the floor of the map was decided, or decided anew.
struct GroundChange {
  int frame = 0;        ///< index in MapRun::frames, after which it was
  double stamp = 0.0;   ///< of the frame [s]
  int hypothesis = 0;   ///< the one taken from then on
  double height = 0.0;  ///< of the run's first camera above it [m]
  std::string reason;
};

/// What mapping a recording gives.
struct MapRun {
  std::vector<MapRunFrame> frames;
  /// The ground over time: of each frame its hypotheses, by frame, then by number.
  std::vector<GroundRecord> ground;
  std::vector<GroundChange> changes;  ///< empty: no ground was found
  std::string no_ground;              ///< why none was found; empty if one was
  /// W from the recording's world: z up, floor at z = 0, origin below the first camera, which looks
  /// along +x. Identity without poses.
  Eigen::Isometry3d T_WD = Eigen::Isometry3d::Identity();
  GroundPrior first;               ///< the ground taken, as the first camera would see it
  BeliefMaps maps;                 ///< null without poses or ground: nothing is mapped
  std::vector<std::string> notes;  ///< images or scans that could not be read: left out, rejected
  /// With loops: T_WC of the frames and the map are corrected, in the frame of the first pose.
  std::optional<MapRunLoops> loops;
  bool cancelled = false;  ///< it ends before the last frame, or on a floor of before
};

/// Who watches a run, as far as there is somebody.
struct MapRunWatch {
  std::function<void(int done, const MapRunFrame&)> progress;  ///< called after each frame
  std::function<bool()> cancelled;                             ///< asked before each frame
};

/// Maps a recording, from frame `first`, at most `max_frames` (0: all).
///
/// The recording's world points anywhere, so the floor is found first, by GroundHypotheses: until
/// enough frames agree on a plane, nothing is mapped. Then the map is made of all frames so far.
/// Whenever another hypothesis is taken, or the estimate of the one taken has moved by more than
/// 0.015 m or 0.01 rad (looked at whenever the frames have doubled, and at the end), the map is
/// cleared and made again from the first frame on: the recording is read again, so memory does not
/// grow with it. A frame that is doubtful (GroundObservation) does not extend the map.
///
/// Without poses that is done in the camera's frame, and then the ground of each frame is measured,
/// but nothing is mapped.
///
/// If no frame shows the ground, all frames are rejected and nothing is mapped. Cancelled, the map
/// is that of the frames so far. Throws InputError if an image cannot be read. One thread; the same
/// recording gives the same bits, but for times.
MapRun run_mapping(const DepthDataset& dataset, const MapRunOptions& options = {}, int first = 0,
                   int max_frames = 0, const MapRunWatch& watch = {});

/// Counts and spreads of a run; NaN where there is nothing to measure.
struct MapSummary {
  /// The hypothesis that is taken in the end, and those that are not; none without a ground.
  std::optional<GroundRecord> taken;
  std::vector<GroundRecord> rejected_grounds;
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
  TimePercentiles hypotheses, check, ground_plane, scan, insert, snapshot, frame;
};
MapSummary summarize(const MapRun& run);

/// One row a frame: number, stamp, state, reason, ground plane, pose entered, rays. No times, so
/// the same recording gives the same bytes.
std::string ground_csv(const MapRun& run);

}  // namespace prospect
