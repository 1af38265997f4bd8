#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/worlds/load_progress.h"
#include "adapters/worlds/world.h"

namespace prospect {

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
  /// [m] Size of the world's voxels, in place of resolution (maps) or 0.05 m (meshes), if more than
  /// 0; of an image without a .yaml and of a MovingAI grid it is pixel_size. Finer than the source
  /// is refused; so is any for a world file, which states its own.
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
};

/// A world by name or path: a built-in name (builtin_world_names()), plan:SEED
/// (random_floor_plan()), else by extension: .yaml/.yml
/// (a world file, or a ROS map if it has the key `image`), .bt/.ot (OctoMap), .pgm/.png/.bmp (bare
/// map image), .map (MovingAI), .obj/.dae/.gltf/.glb/.stl/.ply (mesh_file.h), .world/.sdf
/// (gazebo_world.h), both voxelised at 0.05 m (mesh_world.h). What a source holds that is not in
/// the world is in World::left_out. Throws InputError: unknown name (with the nearest built-in
/// name), missing file, no regular file, unreadable or corrupt content, an option that says nothing
/// of such a source, no place to stand, or a given start at which the body does not fit.
World load_world(const std::string& name_or_path, const WorldOptions& options = {});

/// Sets the world's start to `given` if there is one; else, if the world file states none, to the
/// default: in the largest connected set of standing columns, of the columns within 1 m of the one
/// nearest to the set's centroid, the one with the most clearance; yaw 0. Where there is no
/// standing column, likewise of the columns at which the body fits at some heading; yaw of these
/// the one nearest to 0. Throws InputError if it fits nowhere, or not at `given` or at a start the
/// world file states: if its ground outline there meets the inside of a column that is not free.
/// More room is not asked for: the certificate lets a robot leave that starts near things.
void place_start(World& world, const BodySlice& slice, const std::optional<Pose>& given,
                 bool world_states_start);

}  // namespace prospect
