#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/problem/solver.h"
#include "engine/problem/stop_condition.h"
#include "solvers/evaluator.h"
#include "solvers/options.h"

namespace prospect {

/// What every back end does before and after its own algorithm: strict options, refusal of problems
/// it cannot solve, the evaluated start, problems without a free variable, and no exception out of
/// solve().
class SolverFrame : public Solver {
 public:
  Result solve(const Problem& problem, const WarmStart& warm_start, const Options& options,
               const StopCondition& stop) const final;

  /// The same within the solve of another back end, whose evaluator is `outer`: everything
  /// evaluated here counts there too. The explanation of the result is left empty.
  Result solve_within(Evaluator& outer, const WarmStart& warm_start, const Options& options) const;
  /// The same from each of `starts`, as many at a time as `outer` has threads
  /// (Evaluator::run_beside). None for a start whose turn came after `latest`, but for the first.
  std::vector<std::optional<Result>> solve_within(Evaluator& outer,
                                                  const std::vector<WarmStart>& starts,
                                                  const Options& options,
                                                  StopCondition::Clock::time_point latest) const;

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
  Result solve_with(Evaluator& evaluator, const OptionSet& set, const WarmStart& warm_start) const;
};

/// Sentence for a gradient back end that cannot take the problem; empty if it can.
std::string explain_no_gradient(const Problem& problem);

}  // namespace prospect
