// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/maps/ground_map.h"
#include "engine/maps/map_projection.h"
#include "engine/maps/voxel_grid.h"
#include "models/types.h"

namespace octomap {
class OcTree;
}

namespace prospect {

class EvidenceTable;
class Knobs;
class MapEvidence;

/// One depth image as rays from one origin, in the frame of the pose estimate [m].
/// Pixels without a valid measurement appear in neither list: they say nothing.
struct DepthScan {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Where rays met a surface.
  std::vector<Eigen::Vector3d> hits;
  /// Any point on each ray (beyond the origin) that met nothing within the sensor's range.
  std::vector<Eigen::Vector3d> misses;
  /// Where rays met what does not stay: they clear up to there, and say nothing of what is there.
  std::vector<Eigen::Vector3d> passing{};
  /// How far the sensor measures [m], > 0; what the map's max_range is beyond it does not count.
  double reach = std::numeric_limits<double>::infinity();
};

/// A scan given in B, in the frame of `pose`.
DepthScan transform(const DepthScan& scan_B, const Pose& pose);

/// As far from the origin as a map reaches [voxels]: octree addresses are of 16 bits.
inline constexpr double kFarthestVoxel = 30000.0;

struct OccupancyMapperOptions {
  double resolution = 0.1;  ///< r [m]
  double max_range = 4.0;   ///< [m]: nothing is learned farther from the origin than this
  double z_min = -0.3;      ///< [m]: voxels outside [z_min, z_max] are not kept
  double z_max = 2.5;
  HeightSlice slice;  ///< heights projected on the ground map; its step: what the robot drives down
  /// Sensor model of OctoMap: probabilities of a hit and a miss, and bounds of a voxel's
  /// probability.
  double probability_hit = 0.7;
  double probability_miss = 0.4;
  double probability_min = 0.1192;
  double probability_max = 0.9;  ///< OctoMap suggests 0.971: twice as many misses to clear a ghost
  /// A hit is entered min(r/2, offset_constant + offset_quadratic range^2) [m; 1/m] behind the
  /// measured point, along its ray: a measured surface that coincides with a face of the lattice
  /// would otherwise fall into the free voxel before it half of the time, and walls would grow by a
  /// voxel. About two standard deviations of the range noise is right. Our choice.
  double offset_constant = 0.005;
  double offset_quadratic = 0.003;
  /// How far inside a voxel a ray must run to clear it (see OccupancyMapper) [-]. A ray along a
  /// wall runs in the voxels of the wall as soon as the pose is off by a centimetre; the few hits
  /// in each are outnumbered, and the wall opens. 0.9 and more: every voxel that it pierces, as
  /// OctoMap does.
  double core = 0.35;
  /// Whether the floor may rise: ramps and thresholds are ground where they join it (FloorJoin).
  /// The poses have to follow it, in height and tilt.
  bool slopes = true;
};

/// The knobs (models/knobs.h) of the sensor model; resolution, range and slice come from robot and
/// map.
void describe(Knobs& knobs, OccupancyMapperOptions& options);

/// Voxels of the largest max_range: a scan marks all columns in reach, and each look clears them.
inline constexpr int kMostRangeVoxels = 200;
/// Layers of voxels: the dense mirror holds each column whole, three times.
inline constexpr int kMostLayers = 10'000;

/// What does not fit the resolution, of max_range and of z_min and z_max: "" or the names, the
/// numbers, and what would fit. The OccupancyMapper's constructor asks both, and so does every
/// mission before it begins. Of sound knobs.
std::string range_misfit(const OccupancyMapperOptions& options);
std::string layers_misfit(const OccupancyMapperOptions& options);

/// Occupancy mapping: scans to octree, its dense mirror, and its ground projection.
///
/// One scan updates each voxel at most once, as OctoMap does: l += log-odds of a hit if any ray
/// ends in the voxel, else of a miss if any ray clears it, clamped to the bounds. A hit beyond
/// R = min(max_range, the scan's reach) clears up to R; a miss clears up to R. The rays are walked
/// voxel by voxel, exactly.
///
/// What a ray clears. Pierced is not enough: a ray that only touches a voxel does not show that
/// there is no surface beside it, and a pose that is off takes rays along a surface into it.
///   across   it says something of a voxel only if it passes its vertical axis within core r. How
///            high it does so does not matter: where a wall stands, it stands at any height;
///   upwards  it is inside the layer that it starts in, and inside another one once it is
///            (1/2 - core) r beyond the face that it came through. Before, it grazes: that makes
///            free what is unknown, but does not speak against a hit, so rays along the top of a
///            box or along a floor do not open it.
/// So the rays of a lidar of one plane clear as much on a face of the lattice as in the middle of a
/// layer, and those of one that is tilted clear all the way.
/// With core >= 0.9 the states are those of OctoMap's insertPointCloud on the same points, but in
/// the floor's layers.
///
/// The floor. In its layers, those from z = 0 down to the robot's step (floor_state.h), a ray says
/// something only if it ends in them, or went on through them: it ends, or its range does, deeper
/// than the step. Then there is no surface where it was in them, a "virtual surface": an upper
/// bound of what lies there. So the noise of rays that end on the floor opens no holes in it. A hit
/// that is deeper than the step is entered below the floor's layers. Not so where the step is
/// deeper than z_min, as of a robot that flies: then nothing is known of the floor.
///
/// Ramps and thresholds (`slopes`). The height of the ground is that of what was met, finer than
/// voxels: mean and variance of the points in a voxel, of the newest 100. What of it is ground,
/// FloorJoin says. voxels() and ground() hold each column let down by its level, whole voxels, and
/// octree() says by how many (column_levels.h): heights in them count from the floor, so that a
/// ramp is ground, what stands on it an obstacle, and a gallery over a hall none of the hall's.
/// What is closed is occupied in ground(). octree() is as things are. In the floor's layers of a
/// raised column, too, a ray says something of what is occupied only if it ends in them, or went on
/// through the layer below. On a flat floor all is as without `slopes`, to the bit. Floors below
/// z = 0 are holes.
///
/// Snapshots. octree(), voxels() and ground() return the map after the last insert and never change
/// afterwards: later changes go to another copy as long as a snapshot is held elsewhere. Each map
/// exists up to three times, and a copy that nobody holds is brought up to date by replaying what
/// has changed. So where at most two snapshots are held at a time, one to plan with and one to
/// check with, no whole map is copied; holding more is safe and costs a copy a scan.
///
/// Source: formulation, section 2; OctoMap's sensor model (Hornung et al. 2013).
/// Thread-safety: one thread inserts and takes snapshots; snapshots may be read and released on any
/// thread. Errors: the constructor throws std::invalid_argument on options out of range; insert()
/// never throws for finite or non-finite points (a ray with a non-finite point is ignored).
/// Determinism: the same scans in the same order give the same bits.
class OccupancyMapper {
 public:
  explicit OccupancyMapper(const OccupancyMapperOptions& options = {});
  ~OccupancyMapper();
  OccupancyMapper(OccupancyMapper&&) noexcept;
  OccupancyMapper& operator=(OccupancyMapper&&) noexcept;

  const OccupancyMapperOptions& options() const;

  /// From now on what is entered is written down here, too; null: nowhere. Both must outlive this.
  void record(MapEvidence* evidence, EvidenceTable* table);
  /// Enters what scans have said, in the lattice of this map: what those scans would have made of
  /// it, but for the rounding of the table. Not written down.
  void enter(const MapEvidence& evidence, const EvidenceTable& table);

  /// Enters one scan. Cost: rays x voxels per ray, plus the voxels whose value changes.
  void insert(const DepthScan& scan);

  /// Makes all voxels whose centre lies in the vertical cylinder around `base` [m, in W] free with
  /// certainty, except occupied ones: the space that the robot's own body fills.
  void clear_cylinder(const Eigen::Vector3d& base, double radius, double height);

  /// Makes the floor known, as if it had been seen once, where nothing is known of it and a cell's
  /// centre lies within `radius` [m] of `at` [m, in W]: what somebody states of the start. It
  /// counts as no surface that was seen. Nothing in a map that knows nothing of the floor.
  void assume_floor(const Eigen::Vector2d& at, double radius);

  /// Enters a map that was made before, as if each voxel that it knows had been seen once: what is
  /// seen from now on corrects it. Its surfaces do not count as seen. Throws std::invalid_argument
  /// if it is of another resolution or reaches beyond 30000 voxels from the origin.
  void load(const octomap::OcTree& map);

  /// By how much [m] the columns of voxels() are let down there, in whole voxels.
  double floor_level(const Eigen::Vector2d& at) const;

  std::shared_ptr<const octomap::OcTree> octree();
  std::shared_ptr<const VoxelGrid> voxels();
  std::shared_ptr<const GroundMap> ground();
  BeliefMaps snapshot() { return {octree(), voxels(), ground()}; }

  /// Number of voxels that have ever become occupied: a measure of the surface seen so far.
  std::uint64_t surface_voxels() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
