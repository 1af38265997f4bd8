// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/problem/solver.h"

namespace prospect {

/// Ipopt: primal-dual interior point with a filter line search. The Hessian of the Lagrangian is a
/// limited-memory BFGS one (limited_memory_bfgs.h), handed over as a dense matrix: with Ipopt's
/// own, kept as a low-rank sum, the linear solver works through two right-hand sides a pair in
/// every iteration, four times the instructions of a whole solve. Written for Ipopt 3.11 and 3.14
/// alike; the tests have run with 3.11.9.
///
/// Every registered option of the library is taken under its own name besides the common ones,
/// except those that would print, write files or are about the Hessian.
///
/// Warm start: x alone, or, with lambda, z_lower and z_upper of matching sizes, the full
/// primal-dual point with its barrier parameter.
///
/// Thread-safety: as Solver; but the linear solver MUMPS is not re-entrant, so only one solve at a
/// time runs in a process. The others wait, and keep their deadlines while they do.
std::shared_ptr<const Solver> make_ipopt_solver();

}  // namespace prospect
