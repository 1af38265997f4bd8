#pragma once

#include <cstddef>
#include <string>

#include "adapters/worlds/textured_mesh.h"
#include "adapters/worlds/world.h"

namespace prospect {

struct MeshWorldOptions {
  double resolution = 0.05;  ///< [m] of the voxels
  double height = 2.5;       ///< [m] above the floor that is voxelised; the mesh stays whole
  /// [m] What lies lower above the floor is floor: meshes are not as flat as they look.
  double floor_tolerance = 0.02;
  std::size_t max_voxels = 400'000'000;
};

/// The world of a mesh that stands upright (z up). The mesh is moved along z so that the floor is
/// z = 0, and kept in the world.
///
/// Floor: the lowest height at which triangles that face upwards (within 10 degrees) have at least
/// half as much area as at the height with most of them, heights taken in steps of 5 cm. Where no
/// triangle faces upwards, those that face down count.
/// Voxels: occupied if a triangle touches them (exactly, by separating axes) more than
/// floor_tolerance above the floor; the layer below the floor where a triangle lies between one
/// voxel (at least 0.1 m) below the floor and floor_tolerance above it. Free, for now: what is not
/// occupied and stands over such a floor. All else is unknown. start is left at the origin.
///
/// Throws InputError if there is no floor or the mesh is larger than max_voxels.
World world_from_mesh(TexturedMesh mesh, const std::string& name,
                      const MeshWorldOptions& options = {});

/// Free voxels that are not connected to the start's column above the floor, through faces, become
/// unknown: the inside of things, and the surroundings of a building.
void keep_connected_space(World& world);

}  // namespace prospect
