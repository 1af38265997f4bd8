// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/worlds/left_out.h"
#include "engine/maps/voxel_grid.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

struct TexturedMesh;

/// A piece of floor higher than z = 0, solid below: a ramp, a threshold, a platform. Its top is a
/// plane over a rectangle, finer than the voxels.
struct Slope {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< [m]
  double height = 0.0;                             ///< [m] of the top at `low`
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();  ///< [m] a metre along x and y
  bool contains(const Eigen::Vector2d& p) const {
    return (p.array() >= low.array()).all() && (p.array() < high.array()).all();
  }
  double at(const Eigen::Vector2d& p) const { return height + rise.dot(p - low); }
};

/// A true world for the simulator: what is where, and how much texture its surfaces carry.
///
/// Voxels: kOccupied, kFree, or kUnknown; unknown voxels of the source map, and everything outside
/// the grid, are solid to the robot and opaque to its sensors. The floor is z = 0 of W: readers
/// shift a map by whole voxels so that the floor's surface lies there, and make the layer just
/// below z = 0 (k = -1) occupied under every column that is free in the layer above it, but for
/// where a world file lowers the floor (floor_state.h: missing).
struct World {
  std::string name;
  VoxelGrid voxels;
  Pose start;  ///< B's origin on the floor
  /// Texture density of a surface voxel [features/m^2], by class; texture_class holds one index per
  /// voxel (same indexing as voxels.data()). Empty texture_class: the source says nothing of
  /// texture and a seeded patchy field is used.
  std::vector<double> texture_density;
  std::vector<std::uint8_t> texture_class;
  /// Height of W's z = 0 in the frame of the source map [m].
  double source_floor_height = 0.0;
  /// What cameras see of a world that was read from a mesh; null for all others, whose mesh is that
  /// of their voxels (adapters/robots/simulator/world_mesh.h).
  std::shared_ptr<const TexturedMesh> mesh = nullptr;
  /// What the source holds that is not in this world, for one line to the user.
  LeftOut left_out = {};
  /// What was taken for the scale that the source does not state: "0.05 m a pixel". Empty: it does.
  std::string assumed = {};
  /// Where much of the source's space is unknown that may be free: how much, and which option or
  /// key makes it free, for the line that says that the robot has no room. Empty if little is.
  std::string if_no_room = {};
  /// Share of the source's ground (of an octree or mesh: surfaces with free space above, on all
  /// storeys, furniture included) that lies at z = 0; NaN of sources that have one floor only.
  double floor_share = std::numeric_limits<double>::quiet_NaN();
  /// The floor where it rises (sloped_floor.h). The voxels that lie below it as a whole are
  /// occupied, those that it cuts are free.
  std::vector<Slope> slopes = {};

  bool solid(int i, int j, int k) const { return voxels.state(i, j, k) != CellState::kFree; }
};

/// Texture density [features/m^2] of the surface of voxel (i, j, k): the world's own where it has
/// texture classes, else a patchy field, a function of the position and the seed alone: Voronoi
/// patches about jittered points of a 3 m lattice (patches of 2-4 m), each rich (40, share 50 %),
/// poor (2, share 30 %) or blank (0, share 20 %).
double texture_density(const World& world, int i, int j, int k, std::uint64_t seed);

/// The part of a column that the robot's body sweeps [m], the distance that the centre of the robot
/// keeps from everything not free where there is ample room to stand [m], and the body itself.
struct BodySlice {
  double z_min = 0.1;
  double z_max = 0.5;
  double standing_clearance = 0.28;
  RobotShape shape = CylinderShape{};
  double step = 0.05;  ///< drop of the floor [m] that the robot drives down
};

/// A quick look at a world, for `prospect list worlds` and messages.
struct WorldFacts {
  double free_area = 0.0;      ///< [m^2] columns free over the whole body slice
  double standing_area = 0.0;  ///< [m^2] with ample room to stand, connected to the start
  double width = 0.0, length = 0.0, resolution = 0.0;  ///< [m]
};
WorldFacts describe(const World& world, const BodySlice& slice);

}  // namespace prospect
