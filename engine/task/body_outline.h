// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/robot_shape.h"

namespace prospect {

/// The exact ground projection of an upright body, in B: the union of discs and of one convex
/// polygon. Sphere set: a disc each; cylinder: a disc; box, hull: the polygon.
struct BodyOutline {
  std::vector<Disc> discs;
  std::vector<Eigen::Vector2d> corners;  ///< counter-clockwise; empty: no polygon
};

/// Throws as validate(shape) does.
BodyOutline body_outline(const RobotShape& shape);

}  // namespace prospect
