// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_progress.h"
#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/world.h"

namespace prospect {

struct MeshWorldOptions {
  double resolution = 0.05;  ///< [m] of the voxels
  double height = 2.5;       ///< [m] above the floor that is voxelised; the mesh stays whole
  /// [m] What lies lower above the floor is floor: meshes are not as flat as they look.
  double floor_tolerance = 0.02;
  std::size_t max_voxels = 400'000'000;
  /// [m] Height, in the mesh's frame, of the ground that is meant; none: see world_from_mesh.
  std::optional<double> ground;
  double ground_margin = 0.0;           ///< [m] see world_from_mesh
  std::vector<Eigen::Vector2d> places;  ///< [m] that must be in the world
  bool unknown_is_free = false;         ///< over no floor, too
  LoadProgress progress;
};

/// The world of a mesh that stands upright (z up). The mesh is moved along z so that the floor is
/// z = 0, and kept in the world.
///
/// Floor: the lowest height at which triangles that face upwards (within 10 degrees) have at least
/// half as much area as at the height with most of them, heights taken in steps of 5 cm; or the one
/// nearest to options.ground, at most half a metre off, of those with at least half as much area as
/// any so near, and a twentieth of that of the height with most, where an area counts up to that of
/// the box about all that is steeper than 45 degrees. Where no triangle faces upwards,
/// those that face down count. World::floor_share is the share of the area that faces upwards
/// (within 45 degrees) at most 0.1 m off that height. Ground that is not flat is refused unless a
/// height is given: where of that area within 1 m of the floor's height less than a third is the
/// floor. Extent: if what rises more than 0.15 m above the floor, or above a lower plane under it,
/// covers less than half as much as the whole mesh, and that is more than 1000 m^2, the ground is a
/// plane without end that somebody put under a building: it counts as far as what rises, and
/// ground_margin beyond (at least 5 m where that is less than 3 m wide), and left_out says so.
/// Where nothing rises, 10 m about the origin. 2 m about options.places belong to it, too. Voxels:
/// occupied if a triangle touches them (exactly, by separating axes) more than floor_tolerance
/// above the floor; the layer below the floor where a triangle lies between one voxel (at least 0.1
/// m) below the floor and floor_tolerance above it. Free, for now: what is not occupied and stands
/// over such a floor. All else is unknown. start is left at the origin.
///
/// left_out says so if the mesh seems to lie on its side: along a level axis it is less than half
/// as long as along z, and what faces along that axis (within 10 degrees) has more than 1.5 times
/// the area of what is level.
///
/// Throws InputError if there is no floor, none at the height that is asked for (with the heights
/// there are), the ground is not flat, a vertex lies more than 100 km off, or the mesh is larger
/// than max_voxels.
World world_from_mesh(TexturedMesh mesh, const std::string& name,
                      const MeshWorldOptions& options = {});

/// Free voxels that are not connected to the start's column above the floor, through faces, become
/// unknown: the inside of things, and the surroundings of a building.
void keep_connected_space(World& world);

}  // namespace prospect
