#pragma once

#include <span>

#include "engine/maps/belief.h"
#include "models/robot_shape.h"
#include "models/types.h"

namespace prospect {

/// Whether a map is one of the place where a motion leads, for who checks once more on the newest
/// map what was certified on an older one: a map that is empty, or of elsewhere, has no obstacles.
///
/// At each pose the columns of cells are counted (planar bases: of the ground map; else of voxels
/// at the body's heights) whose centres lie within the body's inscribed radius of B's axis. It is
/// if
///   something is known within kAbout of the body where the motion begins, and
///   half of what it covers, or half of what it covers and did not at its start, is known.
/// Half: the pose that is checked is not the one that was certified, and the border of the known is
/// no wall.
///
/// Maps are not null, poses finite and at least one. Pure. Source: our choice.
bool knows_ground(const Belief& belief, const RobotShape& shape, bool planar,
                  std::span<const Pose> poses);

}  // namespace prospect
