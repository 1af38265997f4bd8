// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// The three problems of quadrotors of jaxipm, which others measure solvers on: N = 29 stages of
/// 0.1 s, every input free, the model of problems/euler_quadrotors.h; what is minimised is
///   sum_{k=0..29} sum_i w_i (x_k[i] - r_k[i])^2,    w = 0 for the quaternion.
/// There the states are variables, too (30 x 13 and 29 x 4 for one quadrotor); here they follow
/// the inputs: the same programme, with the same optima. Positions, velocities and rates have
/// bounds, which are rows of the constraints, two for each.
///
/// Start: hovering. Theirs adds states on the line to (0, 0, -2), which follow no dynamics.
/// Source: Viljoen, "jaxipm" (arXiv 2606.26341), scripts quad_nav_circle, quad_track_avoid,
/// quad_multi_swap at commit 7556f52.

/// quad_nav_circle: to the origin from a place on the circle of radius sqrt(32), at `angle` [rad],
/// past four cylinders, which grow by 1 % of their squared radius a stage. w = 1, r = 0. They take
/// 80 angles from 0 to pi/2, and 80 from -pi/4 to 3 pi/4.
Problem quad_nav_circle(double angle);

/// quad_track_avoid: along (4 cos s, 4 sin s, 2 cos 2s), s = `place` + speed t, with its velocity,
/// past three cylinders that move; 0.5 <= |q|^2 <= 1.5. w = 1. It begins on the path, at rest;
/// theirs begin up to some 1 m beside it. Speeds: 1, 1.5, 2 [rad/s].
Problem quad_track_avoid(double speed, double place);
/// Whether that place lies 0.1 m or more outside of the cylinders, as theirs have to.
bool quad_track_begins_free(double place);

/// quad_multi_swap: 2 or 4 quadrotors on a circle of 3 m change sides, 1 m apart or more in
/// stages 0 to 28. w = 1, of velocities 0.1; r: the place opposite.
Problem quad_multi_swap(int count);

/// Where solves begin: all rotors of all quadrotors at EulerQuadrotors::hover().
Eigen::VectorXd quad_hovering(const Problem& problem);

}  // namespace prospect
