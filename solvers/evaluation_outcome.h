// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "engine/problem/problem.h"

namespace prospect {

/// What became of one request for an evaluation.
enum class EvaluationOutcome {
  kEvaluated,  ///< the numbers are there, all finite
  kRejected,   ///< evaluated, but some term is not defined at this point
  kStopped     ///< not evaluated: the solve is over, the back end must return
};

/// Whether the evaluation of one point gave finite numbers.
inline bool is_usable(const Evaluation& e, Evaluate what) {
  return e.valid[0] && std::isfinite(e.cost[0]) && e.constraints.allFinite() &&
         (what < Evaluate::kGradient || (e.gradient.allFinite() && e.jacobian.allFinite()));
}

}  // namespace prospect
