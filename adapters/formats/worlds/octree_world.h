// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "adapters/formats/worlds/world.h"

namespace octomap {
class OcTree;
}

namespace prospect {

struct OctreeWorldOptions {
  double height = 2.5;  ///< [m] above the floor that is kept
  /// [m] Voxels are merged to the largest multiple of the tree's resolution up to this (0: not): a
  /// merged voxel is occupied if any fine one is, free if at least half of them are, else unknown.
  double resolution = 0.0;
  std::size_t max_voxels = 400'000'000;
  /// [m^3] Largest pocket that is filled with free space; 0 leaves every unknown voxel unknown.
  double max_pocket = 1.0;
  /// [m] Height in the tree's frame of the ground that is meant; none: see world_from_octree.
  std::optional<double> ground;
  bool unknown_is_free = false;  ///< within the box of what is known
};

/// The world of an octree: dense voxels at the tree's resolution from one voxel below the floor to
/// `height` above it; what the tree does not know stays kUnknown, but for pockets.
///
/// What nothing connects to the largest part of the free space (known voxels, with gaps of up to
/// about a metre), beyond that part's bounding box, is left out and told if the box becomes less
/// than half: stray voxels far off cost gigabytes, and a robot gets to none of them. Where the box
/// still has more than 5e7 voxels, so is what only thin rays connect (blocks of a metre of which
/// less than 3 % is known).
///
/// A pocket is a set of unknown voxels, connected through faces, of at most max_pocket, whose other
/// face neighbours are all free: the blind spot of the sensor that made the map, left wherever it
/// stood. It becomes free (our choice): geb079 has a row of them at z = 0.5 m, each a false
/// obstacle as wide as the passage.
///
/// The floor (our choice): a voxel is a surface if it is occupied and the one above it is free. The
/// layer with the most surface voxels is the floor if they cover at least a tenth of what the
/// fullest layer has free; its upper side becomes z = 0. A tree without such a layer (the floor was
/// never mapped) gets its floor just below the lowest layer with at least half the free voxels of
/// the fullest one. With options.ground it is the nearest layer at most half a metre off, of
/// those with at least half as many surface voxels as any so near, and a twentieth of the most
/// anywhere (where there are none: the lowest free one so near). The map is moved by whole voxels
/// only. World::floor_share is the share of all surface voxels that is at most 0.1 m (at least a
/// voxel) off that height, NaN where the floor was not mapped. Ground that is not flat is refused
/// unless a height is given: where of the surface voxels within 1 m less than a quarter is the
/// floor, or where no layer is one although surface voxels with half a metre of room above are half
/// as many as the fullest layer's free ones. start is left at the origin: see place_start.
///
/// Throws InputError if the tree has no free space, no ground at the height that is asked for, no
/// flat ground, or is larger than max_voxels.
World world_from_octree(const octomap::OcTree& tree, const std::string& name,
                        const OctreeWorldOptions& options = {});

}  // namespace prospect
