// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "engine/problem/stop_condition.h"
#include "engine/support/worker_threads.h"
#include "solvers/evaluation_outcome.h"
#include "solvers/judge.h"

namespace prospect {

/// Between every back end and the problem: what the Solver contract promises is kept here, once.
///
///  * asks the StopCondition before every evaluation; after the first kStopped it never evaluates
///    again, however often a back end that is slow to return asks;
///  * keeps the incumbent over everything evaluated: of two points the better one is feasible
///    (violation <= feasibility_tolerance) with the lower cost; else the one that is feasible; else
///    the less violated one, then the cheaper one. A tie keeps the older point;
///  * stores exceptions of terms and of the stop condition (they end the solve with kError) and
///  lets
///    none out, so that no exception crosses a C or Fortran frame;
///  * treats non-finite results as rejected points;
///  * counts, and ends the solve after max_evaluations; also one that goes round in circles, which
///    asks again and again for what is remembered or counts iterations that evaluate nothing;
///  * remembers the last point, so that value, constraints and gradient asked one after another
///  cost
///    one evaluation.
///
/// The back end sees the free variables only: entries with lower == upper are removed. "x" is
/// always a vector of the num_variables() free variables here, "z" one of the problem's. Points are
/// clamped into the bounds before they are evaluated.
///
/// Thread-safety: none; one evaluator a solve. No allocation in evaluate() after the first call.
///
/// Threads. With CommonOptions::threads = T > 1, evaluate_batch() has T chunks evaluated at once,
/// each with a workspace of its own, and then takes them one after another in their order, as if
/// they had been evaluated then: incumbents, counters and the end of a solve have the same bits for
/// any T (a deadline apart). What was evaluated ahead and turns out not to be wanted, because the
/// solve has ended or a chunk is to be exact, is thrown away and not counted. run_beside() does the
/// like with whole solves.
class Evaluator {
 public:
  /// Columns of one call of Problem::evaluate in evaluate_batch(): a deadline is honoured within
  /// one such chunk. Fixed, not adapted to the measured speed, so that results do not depend on the
  /// clock.
  static constexpr int kChunk = 16;

  Evaluator(const Problem& problem, const CommonOptions& options, const StopCondition& stop);
  /// For a back end that is run within the solve of `outer`, which it may not outlive: an
  /// incumbent, a budget and counters of its own. Whatever is evaluated here is evaluated, counted
  /// and compared by `outer` too; what stops `outer` stops this, an exception of a term stops both,
  /// and the end of this one's budget or a fail() of the inner back end leaves `outer` running.
  /// finish() explains nothing.
  Evaluator(Evaluator& outer, const CommonOptions& options);

  /// Back ends that are run within this solve, several at a time: calls solve(k, inner) for each
  /// k of 0..count-1, each on one of the threads with an evaluator of its own, with `options`,
  /// whose incumbent, budget and counters are its own. What they evaluated is counted and compared
  /// here afterwards, one after another in the order of k, as if they had been run then: the same
  /// bits for any number of threads. The stop condition is asked by one of them at a time, and what
  /// it ends is over here, too. An exception of a term ends this solve; what comes after it in the
  /// order of k is thrown away. `solve` must not throw.
  void run_beside(int count, const CommonOptions& options,
                  const std::function<void(int, Evaluator&)>& solve);

  const Problem& problem() const { return problem_; }
  const CommonOptions& options() const { return options_; }

  int num_variables() const { return static_cast<int>(free_.size()); }
  int num_constraints() const { return problem_.num_constraints(); }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  /// Index in z of each free variable.
  const std::vector<int>& free_variables() const { return free_; }
  Eigen::VectorXd reduce(const Eigen::Ref<const Eigen::VectorXd>& z) const;
  /// The fixed variables take their value.
  Eigen::VectorXd expand(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// Centre of the bounds (Problem guarantees finite ones).
  const Eigen::VectorXd& middle() const { return middle_; }

  /// Evaluates the start: warm_start.x clamped into the bounds (empty: the middle of the bounds).
  /// If the problem is not evaluable there: the middle, then random points between the start and
  /// the bounds (seeded), at most 32. `x` is the point evaluated last. Ends the solve with kError
  /// if warm_start.x has the wrong size or a non-finite entry.
  EvaluationOutcome evaluate_start(const WarmStart& warm_start, Evaluate what, Eigen::VectorXd& x);

  /// Value (and gradient) at x.
  EvaluationOutcome evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Evaluate what);
  /// kStages at inputs x and states of one's own (nx x (N+1)), which are no rollout: it counts as
  /// an evaluation, and is never the incumbent.
  EvaluationOutcome evaluate_states(const Eigen::Ref<const Eigen::VectorXd>& x,
                                    const Eigen::Ref<const Eigen::MatrixXd>& states);
  /// Of the last point that evaluate() did not refuse with kStopped. The cost of a rejected point
  /// is that of rejected_cost(), its constraints are those of the incumbent, its derivatives
  /// likewise.
  double cost() const { return cost_; }
  const Eigen::VectorXd& constraints() const { return constraints_; }  ///< m
  const Eigen::VectorXd& gradient() const { return gradient_; }        ///< free variables
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }        ///< m x free variables
  /// With kStages, where the point was not rejected. Of all variables, also the fixed ones.
  const StageDerivatives& stages() const { return evaluation_.stages; }
  /// With kResiduals, where the point was not rejected: see Evaluation.
  const Eigen::VectorXd& residuals() const { return evaluation_.residuals; }
  const ResidualJacobian& residual_jacobian() const {  ///< rows x free variables
    return residual_jacobian_;
  }

  /// A smooth, finite stand-in for the cost where the problem is not evaluable, above all costs
  /// seen, that leads back to the incumbent x*:  f_worst + s (1 + |x - x*|^2 / r^2),  s = 1 +
  /// f_worst - f*, r = half the diagonal of the bounds.  Adds nothing if no point was evaluable so
  /// far (x* = middle).
  double rejected_cost(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient) const;

  /// Values of the columns of X (free variables x B): cost (B; kRejectedCost where rejected) and
  /// violation (B; infinite where rejected). Returns how many columns were evaluated, from the
  /// left; fewer than B means that the solve is over.
  ///
  /// With kScore, a candidate is scored first, and evaluated exactly if its score is better than
  /// the incumbent: a score may choose, but the incumbent and its cost are always exact. What is
  /// missed is within Evaluation::cost_error of the incumbent, and so is the cost written for a
  /// candidate that was scored only. A score and the value that follows it count as one evaluation.
  /// Where most scores have to be followed by the value, some chunks are evaluated exactly at once.
  /// For those who rank candidates, not for those who take differences of costs.
  int evaluate_batch(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::ArrayXd& cost,
                     Eigen::ArrayXd& violation, Evaluate what = Evaluate::kValue);

  /// Asks the stop condition without evaluating. True also once anything else ended the solve.
  bool should_stop() { return should_stop(true); }
  bool stopped() const { return stopped_; }
  /// Why the solve has ended with kError; "" otherwise.
  std::string error() const { return stop_reason_ == StopReason::kError ? stop_detail_ : ""; }
  /// Ends the solve with kError.
  void fail(std::string message);

  bool has_incumbent() const { return has_incumbent_; }
  bool incumbent_feasible() const {
    return has_incumbent_ && incumbent_violation_ <= options_.feasibility_tolerance;
  }
  const Eigen::VectorXd& incumbent() const { return incumbent_; }  ///< free variables
  double incumbent_cost() const { return incumbent_cost_; }
  double incumbent_violation() const { return incumbent_violation_; }
  const Counters& counters() const { return counters_; }
  int evaluations_left() const {
    const int own = options_.max_evaluations - counters_.cost_evaluations;
    return outer_ ? std::min(own, outer_->evaluations_left()) : own;
  }
  /// Time until the stop condition strikes at the latest [s]; infinite: it may never. Thread-safe.
  double seconds_left() const { return outer_ ? outer_->seconds_left() : stop_.left(); }
  void count_iteration() {
    ++counters_.iterations;
    note_idle();
    if (outer_) outer_->count_iteration();
  }

  /// Whether a step from the feasible incumbent down the cost gains more than ten times the
  /// tolerance (judge_first_order()): then it is no optimum, and the better point becomes the
  /// incumbent. False where nothing is known. The evaluations are not counted: a solve that is left
  /// as it is by this is the same with and without.
  bool can_descend();
  /// Evaluates points of all variables for those who judge the solve: neither counted nor compared
  /// nor remembered. Asks the stop condition, which ends only this. Valid as long as the evaluator.
  EvaluatePoint uncounted();
  /// The last evaluation of evaluate(), as the problem gave it: all variables.
  const Evaluation& last_evaluation() const { return evaluation_; }

  /// The result of the solve. What ended it here (deadline, cancellation, evaluations used up, an
  /// exception) goes before what the back end says. `optimum`: the back end's own test of
  /// optimality holds at the incumbent; SolverFrame has that claim judged. Adds the explanation of
  /// x, which costs one more evaluation, the only one after a stop.
  Result finish(StopReason reason, bool optimum, std::string detail, WarmStart next);

 private:
  /// Takes over cost, constraints and derivatives of `evaluation_`; false if they are not finite.
  bool take(Evaluate what);
  void clamp_to_z(const Eigen::Ref<const Eigen::VectorXd>& x);
  bool differs_from_last(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  void consider(const Eigen::Ref<const Eigen::VectorXd>& x, double cost, double violation,
                const Eigen::Ref<const Eigen::VectorXd>& constraints);
  /// Whether that is better than the incumbent.
  bool improves(double cost, double violation) const;
  /// The same, here or outside.
  bool improves_any(double cost, double violation) const;
  void note_cost(double cost);
  /// Ends a solve that has not evaluated anything for long.
  void note_idle();
  /// Without `budget`, evaluations that are used up are no reason to stop.
  bool should_stop(bool budget);
  void count_evaluations(int count, bool gradient);
  void store_exception();
  /// One of run_beside()'s.
  bool beside() const { return !outer_ && !workspace_; }
  Workspace& workspace() {
    if (outer_) return outer_->workspace();
    return workspace_ ? *workspace_ : ahead_.front().workspace;
  }
  /// A chunk of a batch that is evaluated ahead of its turn.
  struct Ahead {
    Workspace workspace;
    Eigen::MatrixXd z;  // kChunk columns, of which `size` count
    int size = 0;
    Evaluation evaluation;
    std::exception_ptr error;
  };
  std::vector<Ahead>& ahead() { return outer_ ? outer_->ahead() : ahead_; }
  WorkerThreads& workers() { return outer_ ? outer_->workers() : *workers_; }
  /// Evaluates the chunks of X from column `first` on, as many as there are threads and evaluations
  /// left; no column is counted or considered. Exceptions are kept with their chunk. Returns the
  /// column after the last.
  int evaluate_ahead(const Eigen::Ref<const Eigen::MatrixXd>& X, int first, Evaluate what);
  /// `ahead`: empty, or what a solve on one thread uses for all its evaluations.
  Evaluator(const Problem& problem, const CommonOptions& options, const StopCondition& stop,
            Evaluator* outer, std::vector<Ahead> ahead);
  /// Takes over what `inner`, one of run_beside()'s, evaluated.
  void adopt(const Evaluator& inner);

  const Problem& problem_;
  CommonOptions options_;
  const StopCondition& stop_;
  Evaluator* outer_;  // null: this is the solve itself
  double begin_ = seconds_by(stop_.clock());

  std::vector<int> free_;
  Eigen::VectorXd lower_, upper_, middle_;
  double radius_ = 1.0;

  // None if there is an outer one; within run_beside() `ahead_` serves all evaluations.
  std::optional<Workspace> workspace_;
  std::vector<Ahead> ahead_;  // by thread
  std::unique_ptr<WorkerThreads> workers_;
  Evaluation evaluation_, exact_evaluation_;
  int exact_chunks_ = 0;  // to come of evaluate_batch() that are not scored
  Eigen::MatrixXd z_;
  Eigen::VectorXd last_x_;
  bool last_known_ = false;
  Evaluate last_what_ = Evaluate::kValue;
  EvaluationOutcome last_outcome_ = EvaluationOutcome::kStopped;

  double cost_ = Problem::kRejectedCost;
  Eigen::VectorXd constraints_, gradient_;
  Eigen::MatrixXd jacobian_;
  ResidualJacobian residual_jacobian_;

  bool has_incumbent_ = false;
  Eigen::VectorXd incumbent_, incumbent_constraints_;
  double incumbent_cost_ = Problem::kRejectedCost;
  double incumbent_violation_ = 0.0;
  double worst_cost_ = 0.0;
  int idle_ = 0;  // requests and iterations since the last evaluation

  bool stopped_ = false;
  StopReason stop_reason_ = StopReason::kConverged;
  std::string stop_detail_;
  bool threw_ = false;  // a term or the stop condition
  Counters counters_;
  std::vector<Improvement> trace_;  // with options_.trace
};

/// A result for a solve that ended before its first evaluation.
Result failed_result(const Problem& problem, std::string detail);

}  // namespace prospect
