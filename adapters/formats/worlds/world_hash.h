// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adapters/formats/worlds/world.h"

namespace prospect {

/// A name for what a mission can see of a world: voxels, texture, start, and the mesh of cameras.
/// Not for its name and file: a world that moves stays the same.
std::uint64_t world_hash(const World& world);

}  // namespace prospect
