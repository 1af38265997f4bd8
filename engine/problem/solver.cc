// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/solver.h"

namespace prospect {

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kDeadline:
      return "deadline";
    case StopReason::kIterationLimit:
      return "iteration limit";
    case StopReason::kCancelled:
      return "cancelled";
    case StopReason::kNumericalTrouble:
      return "numerical trouble";
    case StopReason::kInfeasible:
      return "locally infeasible";
    case StopReason::kUnbounded:
      return "unbounded";
    case StopReason::kError:
      return "error";
  }
  return "?";
}

std::string_view to_string(Quality quality) {
  switch (quality) {
    case Quality::kFeasibleOptimum:
      return "feasible optimum";
    case Quality::kFeasible:
      return "feasible";
    case Quality::kInfeasible:
      return "infeasible";
    case Quality::kNone:
      return "none";
  }
  return "?";
}

}  // namespace prospect
