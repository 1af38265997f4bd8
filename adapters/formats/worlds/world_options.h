// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "adapters/formats/worlds/load_progress.h"
#include "adapters/formats/worlds/up_axis.h"
#include "adapters/formats/worlds/world.h"

namespace prospect {

/// How a world is read (load_world.h).
struct WorldOptions {
  /// Start [x, y in m, yaw in rad] instead of the source's own or the default one. Still checked.
  std::optional<Pose> start;
  /// Where the default start looks for room, and the body that a given start is checked for.
  BodySlice slice;
  /// Of maps; meshes are voxelised as mesh_world.h says. Merge the voxels of a finer map to about
  /// this size [m], a whole multiple of theirs; 0 keeps the source's resolution. A merged voxel is
  /// occupied if any fine one is; of an image it is free if all are, of an octree (whose free space
  /// is full of unseen holes) if at least half are. Merged, the truth has no obstacle thinner than
  /// the map that the robot builds can hold.
  double resolution = 0.1;
  /// [m per pixel] of an image that comes without a .yaml.
  double pixel_size = 0.05;
  /// Height to which the cells of a 2-D map are extruded [m].
  double wall_height = 2.0;
  /// [m] Size of the world's voxels, in place of resolution (maps), 0.05 m (meshes) or what a
  /// cloud's points allow, if more than 0; of an image without a .yaml and of a MovingAI grid it is
  /// pixel_size. Finer than the source is refused; so is any for a world file, which states its
  /// own.
  double voxel_size = 0.0;
  /// What the source does not know counts as free.
  bool unknown_is_free = false;
  /// [m] In the source's frame: take the storey whose ground lies nearest to this height, at most
  /// half a metre off (octrees and meshes; others are refused).
  std::optional<double> floor;
  /// Of meshes and Gazebo worlds.
  LoadProgress progress;
  /// [m] How far beyond what stands on it the ground of a mesh counts, where it is much larger than
  /// that (mesh_world.h).
  double ground_margin = 0.0;
  /// [m] Where the task leads: ground of a mesh that would not count does there.
  std::vector<Eigen::Vector2d> places;
  /// Of meshes and clouds: the axis of the file's coordinates that is up, whatever it says; none:
  /// what it says.
  std::optional<UpAxis> up;
};

}  // namespace prospect
