// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "problems/function_problem.h"

/// Twelve small problems with known optima, with and without constraints.
namespace prospect::zoo {

FunctionProblem rosenbrock();
/// n = 10: sum_i (i+1) (x_i - t_i)^2 with every third t_i outside the bounds.
FunctionProblem bounded_quadratic();

// Hock and Schittkowski, "Test examples for nonlinear programming codes" (1981), by their numbers;
// absent bounds are replaced by wide ones.
FunctionProblem hs12();
FunctionProblem hs21();
FunctionProblem hs22();
FunctionProblem hs29();
FunctionProblem hs35();
FunctionProblem hs43();
FunctionProblem hs76();

/// Six-hump camel back: two of its six minima are global.
FunctionProblem camel();

std::vector<FunctionProblem> well_scaled();

// Variables in units far apart, wide bounds, no constraints: what a method takes for a small step
// is one in the largest unit alone.

/// A curved valley: (x/1e5 - 3)^2 + 100 (y - x/4e5)^2.
FunctionProblem pressure();
/// The largest product of a load and a speed, in a corner of the bounds.
FunctionProblem cargo();

std::vector<FunctionProblem> badly_scaled();

}  // namespace prospect::zoo
