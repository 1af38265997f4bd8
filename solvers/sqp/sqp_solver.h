// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/problem/solver.h"

namespace prospect {

/// Sequential quadratic programming with curvature by stage. In each iteration a convex quadratic
/// programme gives the step,
///
///   min_d  g^T d + 1/2 d^T B d    s.t.  c + J d >= 0,   lower <= x + d <= upper
///   B = sum_k S_k^T P_k S_k + H_u + Q
///
/// with g, c, J and the sensitivities S_k of the states (StageDerivatives). A cost of a planning
/// problem is a function of the trajectory, so its curvature is one small matrix a stage:
///
///  * P_k, nx x nx, is the second derivative by x_k, from differences of the stages' gradients at
///    the start (one evaluation for each entry of the state: all stages are moved at once), then
///    from the symmetric rank-one formula, without further evaluations; its eigenvalues are raised
///    to a floor (StageCurvature), `least_eigenvalue` at first, a quarter of it after each full
///    step that gains at least half of what it promised, four times it after any other: near a
///    flat minimum a fixed floor makes small steps that promise little. The curvature of the
///    dynamics is left out.
///  * H_u is the Gauss-Newton Hessian of costs of inputs alone.
///  * Q is a damped BFGS approximation of what is left of the Lagrangian's Hessian in the variables
///    that move no state: all of it in a plain nonlinear programme, nothing in a planning problem.
///    It begins as 1 over the squared range of each variable, so that units do not matter.
///
/// Where every variable moves a state and the step breaks no linearised constraint, it is found
/// stage by stage (StageProgramme), else as a dense programme (QuadraticProgram).
///
/// The line search is that of the exact penalty f + rho max(0, -min_r c_r), with a second-order
/// correction where the full step violates the constraints more. If the linearised constraints have
/// no common point, the step is that of the same penalty of them (one more variable).
///
/// With `lifted` iterations the solve begins where the states do not follow the dynamics: all of
/// them at x_0. The iterations then move states and inputs together, as multiple shooting does, and
/// close the gaps to first order (the drift e_k of StageDerivatives). After them the states are
/// those of the inputs. What is returned is always a point evaluated that way.
///
/// Source: Nocedal and Wright (2006), chapter 18; stage Hessians projected, Verschueren and others
/// (2017); the lifted start, Bock and Plitt (1984).
std::shared_ptr<const Solver> make_sqp_solver();

}  // namespace prospect
