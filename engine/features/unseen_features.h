// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "engine/features/local_texture.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/landmark_map.h"
#include "engine/support/resumable.h"
#include "models/types.h"

namespace prospect {

struct UnseenFeatureOptions {
  double density = 5.0;     ///< rho [1/m^2]: features a square metre of unknown ground; 0: none
  double block = 1.5;       ///< side of a block [m], rounded to whole cells
  double range = 9.0;       ///< blocks farther than this from the robot are left out [m]
  double height = 0.5;      ///< above the ground where a block's features stand [m]
  int max_blocks = 75;      ///< the nearest are kept
  double image_cell = 0.0;  ///< LandmarkMap::image_cell
};

/// What the tracker will find where nothing has been seen yet: for each block of ground with
/// unknown cells a landmark that stands for rho s(centroid) features a square metre of these, at
/// their centroid, with survival 1, and visible from everywhere. s: LocalTexture, null: 1. They are
/// as crowded as such a density is: image_cell^2 rho s.
///
/// With an occlusion table that dims rays by exp(-lambda length in unknown space), their expected
/// number in view is that of a Poisson field of surfaces: rays into the unknown end at the rate of
/// lambda, and where they end there is texture. Unknown ground behind known walls does not count,
/// known ground neither: what is textured there is in the landmark map, what is not is blank.
/// Such a robot's count of features does not fall along a plan that leads beyond the frontier,
/// as the count of those mapped now does.
///
/// Blocks are aligned in W; ids are from 2^63 up. Ordered by azimuth around the pose (ties: by id).
/// Deterministic. Errors: std::invalid_argument on an option out of range. Source: ours.
std::vector<Landmark> unseen_features(const GroundMap& ground, const Pose& pose,
                                      const UnseenFeatureOptions& options,
                                      const LocalTexture* texture = nullptr,
                                      const PausePoint& pause = {});

}  // namespace prospect
