// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "engine/maps/grid.h"
#include "engine/maps/landmark_map.h"
#include "engine/support/resumable.h"

namespace prospect {

/// What is wrong with a landmark, "position is not finite; expected ...", empty if nothing is:
///
///   position, covariance  finite, within `farthest` [m] and 10^12 m^2; the covariance without a
///                         negative eigenvalue (up to rounding: -10^-6 of its largest entry)
///   creation_direction    of length 1, to 10^-3;  creation_range > 0, finite
///   0 <= survival <= 1,   0 < multiplicity <= 10^6,   0 <= per_cell <= 10^6
///
/// Never throws. Thread-safety: none needed.
std::string fault_of(const Landmark& landmark, double farthest = kFarthest);

/// A landmark map that a planner can use whatever it was given.
struct UsableLandmarks {
  std::shared_ptr<const LandmarkMap> map;  ///< the given one if nothing is wrong with it
  int dropped = 0;                         ///< landmarks left out
  /// The first fault: "landmark 7: survival is 1.5; expected 0 to 1". Not of a landmark left out
  /// only if feature_density or image_cell is out of its range (0 to 10^5 / m^2, 0 to 1), which
  /// then counts as 0, or odometry_noise is out of that of its knobs, which is then left out.
  std::string fault;
};

/// `map` is not null. Cost: 20 ns a landmark where nothing is wrong; else the map is copied.
UsableLandmarks usable_landmarks(std::shared_ptr<const LandmarkMap> map,
                                 const PausePoint& pause = {});

}  // namespace prospect
