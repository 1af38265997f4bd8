// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <optional>

namespace prospect {

/// Whether a robot at p has got nearer, by `distance` [m], than the nearest place q where it has
/// been on its way:
///
///     V(p) <= V(q) - distance,
///
/// V the cost-to-go [m] as it is now, at both. q becomes p then, and where there is none yet, or V
/// says nothing of it (+infinity). V is finite at p. Throws what V throws.
inline bool got_nearer(std::optional<Eigen::Vector2d>& q, const Eigen::Vector2d& p,
                       const std::function<double(const Eigen::Vector2d&)>& V, double distance) {
  const double nearest = q ? V(*q) : 0.0;
  const bool begins = !q || !std::isfinite(nearest);
  if (!begins && !(V(p) <= nearest - distance)) return false;
  q = p;
  return !begins;
}

}  // namespace prospect
