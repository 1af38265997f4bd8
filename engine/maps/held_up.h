// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "engine/maps/grid.h"

namespace prospect {

/// Where a path is closed (Traversability::close) on which a robot was held up, though the map says
/// that it is free. The same for all that leads a robot.
inline constexpr double kHeldUpRadius = 0.3;  ///< [m] of the disc that is closed
inline constexpr double kHeldUpWithin = 2.0;  ///< [m] how far ahead the narrow place may lie

/// The middle of that disc for a robot at p that does not get on in a direction (unit vector in W):
/// 0.4 m ahead, beyond its own cell. None if the direction is not finite or that is outside.
inline std::optional<Cell> held_up_at(const GridFrame& frame, const Eigen::Vector2d& p,
                                      const Eigen::Vector2d& direction) {
  constexpr double kAhead = 0.4;  // [m]
  if (!direction.allFinite()) return std::nullopt;
  const Eigen::Vector2d ahead = p + kAhead * direction;
  const Cell at = frame.cell(ahead.x(), ahead.y());
  return frame.contains(at) ? std::optional<Cell>(at) : std::nullopt;
}

}  // namespace prospect
