// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/maps/belief.h"
#include "models/types.h"

namespace prospect {

/// What is true of a robot at one instant, for evaluation. What nobody knows is NaN.
struct TrueState {
  Pose pose;
  double coverage = 0.0;            ///< share of what it can reach that it has really seen
  double seen_area = 0.0;           ///< [m^2]
  double localization_error = 0.0;  ///< [m]
  double path_length = 0.0;         ///< [m]
  int collisions = 0;
  int losses = 0;       ///< of localization
  bool fallen = false;  ///< a wheel of it stands where there is no floor: over an edge, in a hole
  int bumps = 0;        ///< how often somebody ran into it
  std::vector<Eigen::Vector2d> people{};  ///< where they are, in the true world [m]
};

/// Who knows what is true of a robot. Nothing that drives it may ask. Thread-safety: one thread at
/// a time.
class Truth {
 public:
  virtual ~Truth() = default;
  /// After each planning step, with its belief.
  virtual TrueState at(const Belief& belief) = 0;
  /// The newest that is known.
  virtual TrueState newest() const = 0;
};

}  // namespace prospect
