// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "engine/maps/belief.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

/// Why a belief's maps are none of the place where a motion leads; empty if they are. For who
/// checks once more on the newest maps what was certified on older ones: a map that is empty, or of
/// elsewhere, has no obstacles.
///
/// The octree is there, and all three maps are of one resolution. At each pose the columns of cells
/// are counted (planar bases: that the ground map knows, and of which the voxels know something;
/// else of voxels at the body's heights) whose centres lie within the body's inscribed radius of
/// B's axis;
///   something is known within kAbout of the body where the motion begins, and
///   half of what it covers, or half of what it covers and did not at its start, is known.
/// Half: the pose that is checked is not the one that was certified, and the border of the known is
/// no wall.
///
/// Voxels and ground are not null, poses finite and at least one. Pure. Source: our choice.
std::string unknown_ground(const Belief& belief, const RobotShape& shape, bool planar,
                           std::span<const Pose> poses);

}  // namespace prospect
