// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"
#include "problems/stated_programme.h"

namespace prospect {

/// A unicycle has to find the inputs behind a path that passes a disc, which is there `discs`
/// times: the optimum is 0. Start: at rest. N = 20, M = 10, n = 20, m = 20 discs.
struct PathProblem {
  Problem problem;
  Eigen::VectorXd solution;  ///< z
  StatedProgramme stated;    ///< the same as expressions; start: at rest
};

PathProblem path_problem(int discs = 1);

}  // namespace prospect
