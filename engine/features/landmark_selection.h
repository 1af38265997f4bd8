// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "engine/features/visibility_prediction.h"
#include "engine/maps/landmark_map.h"
#include "engine/support/resumable.h"
#include "models/types.h"

namespace prospect {

/// At most `max_count` landmarks that stand for all that can be visible to a camera within `reach`
/// [m] of `pose`.
///
/// A landmark can matter if some camera position in the ball of radius `reach` around the pose lies
/// within its range of depths and scales and within its cone of views (limits widened by four
/// logistic widths; fields of view up to 96 degrees on the diagonal), and if it is finite with
/// survival > 0. If more remain than `max_count`, those in one cell of a lattice fixed in W that
/// were made from one quarter of directions are taken together, in the finest of the lattices of
/// 0.2 m, 0.2 sqrt(2) m, ... that leaves few enough; beyond 1000 m the lowest ids are kept. The one
/// with the lowest id stands for its cell: its multiplicity is the sum of theirs, its survival and
/// its per_cell are their means by multiplicity. So the count that they predict is that of all, but
/// for where in its cell a landmark lies (our choice; the best of each direction, weighted,
/// predicted 17 % too many and was off by half as much again). The lattice does not move with the
/// robot, so the same ones are chosen again at the next step.
///
/// The result is ordered by azimuth around the pose (ties: by id), which lets the prediction skip
/// runs of points behind the camera. Deterministic, and independent of the order in the map.
/// `reach` should contain the camera's offset from the base.
std::vector<Landmark> select_landmarks(const LandmarkMap& map, const Pose& pose, double reach,
                                       int max_count, const VisibilityParameters& parameters = {},
                                       const PausePoint& pause = {});

}  // namespace prospect
