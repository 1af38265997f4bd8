// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/problem/solver.h"
#include "engine/problem/stop_condition.h"
#include "solvers/evaluator.h"
#include "solvers/options.h"
#include "solvers/problem_scale.h"

namespace prospect {

/// What every back end does before and after its own algorithm: strict options, refusal of problems
/// it cannot solve, the evaluated start, problems without a free variable, and no exception out of
/// solve().
///
/// What the algorithm comes to is judged (judge.h): an optimum is claimed only where it is proven,
/// and an infeasible end where no step lessens the violation has the stop reason kInfeasible. A
/// problem whose cost or constraints are in no plain units at its start is solved in others
/// (problem_scale.h). Where the judge finds a better point, or the units at the end are others, the
/// algorithm goes on from there, with the evaluations that are left, up to kRounds times in all.
/// The evaluations of the judge are not counted; they are made while the stop condition allows.
class SolverFrame : public Solver {
 public:
  Result solve(const Problem& problem, const WarmStart& warm_start, const Options& options,
               const StopCondition& stop) const final;

  /// The same within the solve of another back end, whose evaluator is `outer`: everything
  /// evaluated here counts there too. The explanation of the result is left empty.
  Result solve_within(Evaluator& outer, const WarmStart& warm_start, const Options& options) const;
  /// The same from each of `starts`, as many at a time as `outer` has threads
  /// (Evaluator::run_beside). None for a start whose turn came after the time was over, but for the
  /// first.
  std::vector<std::optional<Result>> solve_within(Evaluator& outer,
                                                  const std::vector<WarmStart>& starts,
                                                  const Options& options) const;

 protected:
  /// Options that are taken too, but are too many to be listed by options().
  virtual std::vector<OptionInfo> further_options() const { return {}; }
  /// Records options out of range through OptionSet::require().
  virtual void check_options(OptionSet&) const {}
  /// What the algorithm needs at its start.
  virtual Evaluate start_evaluation() const { return Evaluate::kGradient; }
  /// The algorithm, from the evaluable point `start` (evaluated last), with at least one free
  /// variable. May throw.
  virtual Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
                     const Eigen::VectorXd& start) const = 0;

 private:
  /// Empty, or why the solve cannot begin.
  std::string explain_refusal(const Problem& problem, OptionSet& set) const;
  OptionSet read(const Options& options) const;
  /// With the start evaluated before: `start`, of which `outcome` came.
  Result solve_from(Evaluator& evaluator, const OptionSet& set, const WarmStart& warm_start,
                    EvaluationOutcome outcome, const Eigen::VectorXd& start) const;
  Result solve_with(Evaluator& evaluator, const OptionSet& set, const WarmStart& warm_start) const;
  Result solve_in_rounds(const Problem& problem, const OptionSet& set, const WarmStart& warm_start,
                         const StopCondition& stop) const;
  /// One round in units of `scale`, from warm_start.x. The result is in those of the problem.
  Result solve_scaled(const Problem& problem, const ProblemScale& scale, const OptionSet& set,
                      const CommonOptions& common, const WarmStart& warm_start,
                      const StopCondition& stop) const;
};

/// Sentence for a gradient back end that cannot take the problem; empty if it can.
std::string explain_no_gradient(const Problem& problem);

}  // namespace prospect
