// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "engine/problem/problem.h"
#include "problems/stated_programme.h"

namespace prospect {

/// R1: a planar exploration problem stated exactly, so that any tool can solve it. Written as a
/// user of the library writes a problem: its model and its terms are their own, against the headers
/// of `models` and `engine`. SI units; s(a) = 1 / (1 + exp(-a/10)).
///
///   x = (px, py, theta), u = (v, w), Euler's rule with dt = 0.2, N = 20 stages, u_k free (M = N:
///   40 variables), 0 <= v <= 0.7, |w| <= 1
///   J = sum_{k=1..N} [ 20 sum_{12 discs} 0.5 (1 - tanh(8 (d - 0.35))) + 0.5 softplus((20-n)/5)
///                      - 0.3 sum_{10 blobs} exp(-|p + 1.5 (cos theta, sin theta) - b|^2 / 1.28) ]
///     + sum_{k<N} [ 0.05 w_k^2 + 0.1 (v_k - 0.5)^2 + 0.2 (w_k - w_{k-1})^2 ],   w_{-1} = 0
///   d = distance to the disc's centre - 0.25
///   n = sum_{150 points} s(u) s(640-u) s(v) s(480-v) / (1 + exp(-(zc-0.5)/0.1)), a camera at
///   height 0.5 that looks ahead, f = 450, centre (320, 240); 0 where zc <= 0.05
///
/// Discs, points and blobs are drawn from std::mt19937 with the seeds 7, 11 and 13 through
/// std::uniform_real_distribution<double> of libstdc++, coordinate by coordinate: discs x in
/// [1,5], y in [-2.5,2.5]; points x in [2,8], y in [-4,4], z in [0.2,2.2]; blobs x in [2,7], y in
/// [-4,4].
///
/// The step of n at zc = 0.05 is at most 0.011 points and the collision term has a kink at a disc's
/// centre; every tool measured on R1 takes it for smooth, and so does this.
/// Check value: J = 404.3937943800 at x_0 = 0 and r1_cold().
/// Source: the project's measurements of peers.

/// The three terms that depend on the world, and the one that does not, each with exact gradients.
std::shared_ptr<const Term> make_r1_collision();  ///< weight 20
std::shared_ptr<const Term> make_r1_features();   ///< weight 0.5
std::shared_ptr<const Term> make_r1_gain();       ///< weight -0.3: a cost
std::shared_ptr<const Term> make_r1_inputs();     ///< weight 1

/// R1 from the state x0 = (px, py, theta).
Problem make_r1(const Eigen::Vector3d& x0 = Eigen::Vector3d::Zero());

/// The same as expressions. z = (v_0, w_0, v_1, ...), start: r1_cold(); no optimum.
StatedProgramme r1_stated(const Eigen::Vector3d& x0 = Eigen::Vector3d::Zero());

/// The cold guess: v = 0.5, w = 0 all along.
Eigen::VectorXd r1_cold();

/// Starts around the origin: px, py in [-0.5, 0.5], theta in [-0.6, 0.6], drawn one after the other
/// from std::mt19937(seed). S30 is r1_starts(17, 30).
std::vector<Eigen::Vector3d> r1_starts(unsigned seed, int count);

/// The least J known of each start of S30, to four digits: the best of 200 SLSQP solves from random
/// piecewise constant inputs each. Not proven to be global.
const std::array<double, 30>& s30_best_known();

/// Whether J counts as solved: within 1 % or 0.01 of the best known.
bool r1_solved(double J, double best_known);

}  // namespace prospect
