// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "perception/odometry/lattice_cell.h"

namespace prospect {

/// Which points were met from two places. A depth that is altogether wrong, as of a wrong match, is
/// the same again from the same place, but elsewhere from another one; a surface is where it was.
///
/// Points [m, in W] are kept in cubes of side `cell`, each with the eye that met it first. A point
/// at p, seen from e with the standard deviation s [m] along its ray, was met before if one of the
/// cubes that the ray passes within 2 sqrt(2) s of p, at steps of half a cube, has an eye at least
/// kApart from e. Memory grows with the surface. Thread-safety: one thread. Points that are not
/// finite, or beyond a million cubes, were never met.
class MetTwice {
 public:
  static constexpr double kApart = 0.1;  ///< [m] between the places of two looks

  explicit MetTwice(double cell) : cell_(cell) {}

  /// Keeps the point; true if it was met before, from another place.
  bool meet(const Eigen::Vector3d& eye, const Eigen::Vector3d& p, double sigma) {
    constexpr double kFarthest = 1e6, kWidth = 2.8284271247461903;  // cubes; 2 sqrt(2)
    constexpr int kMostSteps = 100;                                 // to either side
    const double range = (p - eye).norm(), farthest = kFarthest * cell_;
    if (!(p.cwiseAbs().maxCoeff() < farthest) || !(range > 0.0)) return false;
    const double step = 0.5 * cell_;
    const Eigen::Vector3d ahead = (p - eye) * (step / range);
    const int steps = static_cast<int>(std::clamp(kWidth * sigma / step, 0.0, 1.0 * kMostSteps));
    bool met = false;
    for (int n = -steps; n <= steps && !met; ++n) {
      const auto at = eyes_.find(lattice_cell(p + n * ahead, cell_));
      met = at != eyes_.end() && (at->second.cast<double>() - eye).norm() >= kApart;
    }
    eyes_.try_emplace(lattice_cell(p, cell_), eye.cast<float>());
    return met;
  }

 private:
  double cell_;
  std::unordered_map<std::uint64_t, Eigen::Vector3f> eyes_;
};

}  // namespace prospect
