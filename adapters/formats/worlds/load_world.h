// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/formats/worlds/world_options.h"

namespace prospect {

/// A world by name or path: a built-in name (builtin_world_names()), plan:SEED
/// or plan:SEED:COLUMNSxROWS (random_floor_plan()), else by extension: .yaml/.yml
/// (a world file, or a ROS map if it has the key `image`), .bt/.ot (OctoMap), .pgm/.png/.bmp (bare
/// map image), .map (MovingAI), .obj/.dae/.gltf/.glb/.stl/.ply (mesh_file.h), .world/.sdf
/// (gazebo_world.h), both voxelised at 0.05 m (mesh_world.h), .pcd and a .ply without faces
/// (point_cloud_file.h, cloud_world.h). What a source holds that is not in
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
