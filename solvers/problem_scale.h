// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "solvers/judge.h"

namespace prospect {

/// Units of cost and constraints in which the tolerances of back ends fit a problem:
///
///   f' = (f - offset) / cost,     c'_r = c_r / constraint_r
///
/// A unit is what a typical change of the variables (typical_change()) changes the cost or the
/// constraint by, or the constraint's value if that is more, as a power of two. What is plain
/// (is_plain_unit(), is_plain_cost()) keeps unit 1 and offset 0: so do planning problems.
struct ProblemScale {
  double cost = 1.0, offset = 0.0;
  Eigen::VectorXd constraints;  ///< m; empty: all 1

  bool plain() const { return cost == 1.0 && offset == 0.0 && constraints.size() == 0; }
  /// Whether a tolerance means much the same in both.
  bool like(const ProblemScale& other) const;

  /// The problem in these units, with the same variables.
  Problem apply(const Problem& problem) const;
  WarmStart apply(WarmStart start) const;
  /// A result of the problem in these units as one of the problem; its violation stays in these
  /// units, so that a tolerance of 1e-6 has one meaning for all constraints.
  void undo(const Problem& problem, Result& result) const;
};

/// What an evaluation at x says at once, for those who have it: plain in all but rare cases. `e`
/// with or without derivatives.
bool looks_plain(const Problem& problem, const Eigen::VectorXd& z, const Evaluation& e);

/// What a typical change of the variables around z changes the cost by: its gradient there, where
/// the problem has one, or the median of the changes to eight points, if that is more. 0 where
/// nothing can be evaluated. Deterministic.
double cost_change_near(const Problem& problem, const Eigen::VectorXd& z,
                        const EvaluatePoint& evaluate);

/// The scale near z, from the same points. Plain where nothing can be evaluated. Deterministic.
ProblemScale scale_near(const Problem& problem, const Eigen::VectorXd& z,
                        const EvaluatePoint& evaluate);

}  // namespace prospect
