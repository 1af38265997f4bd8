#pragma once

#include <vector>

#include "engine/landmark_map.h"
#include "engine/terms/visibility_prediction.h"
#include "models/types.h"

namespace prospect {

/// At most `max_count` landmarks that can be visible to a camera within `reach` [m] of `pose`.
///
/// A landmark can matter if some camera position in the ball of radius `reach` around the pose lies
/// within its range of depths and scales and within its cone of views (limits widened by four
/// logistic widths; fields of view up to 96 degrees on the diagonal), and if it is finite with
/// survival > 0. If more remain than `max_count`, they are taken in turn from 32 sectors of azimuth
/// around the pose, the one with the largest bound on survival * P_range * P_view first, so that no
/// direction is emptied in favour of another. Those chosen stand for all of their sector: each
/// multiplicity is times the sum of the bounds of all over that of the chosen (our choice). Without
/// it a rich view counts for no more than its share of max_count: 300 landmarks around the robot
/// are at most 60 in a view, however many will be tracked.
///
/// The result is ordered by azimuth around the pose (ties: by id), which lets the prediction skip
/// runs of points behind the camera. Deterministic, and independent of the order in the map.
/// `reach` should contain the camera's offset from the base.
std::vector<Landmark> select_landmarks(const LandmarkMap& map, const Pose& pose, double reach,
                                       int max_count, const VisibilityParameters& parameters = {});

}  // namespace prospect
