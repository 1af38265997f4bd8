// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "engine/problem/problem.h"
#include "engine/problem/solver.h"

namespace prospect {

/// Violation [m and the like] up to which a candidate counts as feasible when candidates are
/// compared: the certificate, not this number, decides what may be executed.
inline constexpr double kFeasible = 1e-3;

/// A point of a problem's variables that may become the plan: a seed, or what the solver made of
/// one.
struct Candidate {
  std::string name;   ///< of the seed
  Eigen::VectorXd z;  ///< n
  double cost = Problem::kRejectedCost;
  double violation = 0.0;
  std::optional<Result> result{};  ///< of the solver, for polished ones
  double error = 0.0;              ///< that the cost may have: of a score
  double features = 0.0;           ///< of the visible features, not weighted
  bool stops = false;              ///< Seed::stops
  std::size_t rank = 0;            ///< of its seed, in the order in which they were made

  bool feasible() const { return violation <= kFeasible; }

  /// Better: feasible ones by their cost come before the others by their violation.
  bool operator<(const Candidate& other) const {
    if (feasible() != other.feasible()) return feasible();
    if (!feasible() && violation != other.violation) return violation < other.violation;
    return cost < other.cost;
  }
};

}  // namespace prospect
