// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/problem/problem.h"
#include "engine/problem/stop_condition.h"

namespace prospect {

/// Why a solve ended. Says nothing of how good the incumbent is: see Quality.
enum class StopReason {
  kConverged,
  kDeadline,
  kIterationLimit,  ///< iterations, evaluations or samples used up
  kCancelled,
  kNumericalTrouble,  ///< the method could not go on; the incumbent stands
  kInfeasible,        ///< no small step lessens the violation of the incumbent
  kUnbounded,  ///< the cost falls as far as it was followed: no bound that was stated ends it
  kError       ///< the problem threw, an option was wrong, the back end is absent; see detail
};

/// How good the incumbent is. Says nothing of why the solve ended.
enum class Quality {
  kFeasibleOptimum,  ///< feasible, the method's own test holds, and test_optimality() proves it
  kFeasible,         ///< violation <= tolerance
  kInfeasible,       ///< a point was evaluated, none feasible: the least violated one
  kNone              ///< no point could be evaluated
};

std::string_view to_string(StopReason reason);
std::string_view to_string(Quality quality);

/// What one solve hands to the next on the same or a shifted problem. Empty vectors mean "none".
struct WarmStart {
  Eigen::VectorXd x;                 ///< n; clamped into the bounds by every back end
  Eigen::VectorXd lambda;            ///< m, multipliers of the constraints (>= 0)
  Eigen::VectorXd z_lower, z_upper;  ///< n, multipliers of the bounds (>= 0)
  double mu = 0.0;                   ///< barrier parameter, 0 = unknown
  double time = 0.0;                 ///< [s], start of the horizon x belongs to
  /// nx x (N+1) nx, node after node: second derivatives of the cost by the states at x, as far as
  /// the back end knows them.
  Eigen::MatrixXd stage_hessians;
  Eigen::MatrixXd seeds;  ///< n x S: further points to start from, the likely best first, for back
                          ///< ends that compare starts
};

using OptionValue = std::variant<double, int, std::string>;
using Options = std::map<std::string, OptionValue>;

/// What can be set, for `prospect list solvers` and for checking.
struct OptionInfo {
  std::string name;
  OptionValue fallback;
  std::string description;  ///< with unit and range
};

/// Options every back end takes.
struct CommonOptions {
  int max_evaluations = 10000;  ///< cost evaluations, gradients included
  double tolerance = 1e-6;      ///< relative change of cost that counts as converged
  double feasibility_tolerance = 1e-6;
  std::uint64_t seed = 1;
  bool trace = false;  ///< keep Result::trace
  /// That share the evaluation of candidates and the polishing of basins, where the back end has
  /// the option `threads`.
  int threads = 1;
};

struct Counters {
  int cost_evaluations = 0;
  int gradient_evaluations = 0;
  int iterations = 0;
};

/// The incumbent at the moment it became better.
struct Improvement {
  double seconds = 0.0;  ///< since the solve began, by the clock of the stop condition
  int evaluations = 0;   ///< cost evaluations so far; of a batch: at the end of its chunk
  double cost = Problem::kRejectedCost;
  double violation = 0.0;
};

struct Result {
  StopReason stop = StopReason::kError;
  Quality quality = Quality::kNone;
  Eigen::VectorXd x;  ///< the incumbent: best feasible point evaluated, else the least violated
  double cost = Problem::kRejectedCost;
  double violation = 0.0;
  Explanation explanation;  ///< of x
  WarmStart next;
  Counters counters;
  double seconds = 0.0;  ///< that it took, by the clock of the stop condition
  /// With the option `trace`: every improvement of the incumbent, the last one is the result.
  std::vector<Improvement> trace;
  std::string detail;  ///< one sentence
};

/// A back end. It solves exactly the Problem it is given; it has no cost of its own.
///
/// Contract, tested on every back end by the same suite:
///  * the incumbent is tracked in the evaluator, so Result::x is the best of all points evaluated;
///  * `stop` is asked before every evaluation: a solve ends within one evaluation of its deadline;
///  * no exception leaves solve() or crosses a foreign frame: a throwing term ends in kError;
///  * non-finite values are rejections, never results;
///  * an unknown or mistyped option is kError, with the nearest valid name in `detail`;
///  * same problem, warm start, options and seed: the same bits (unless a deadline struck).
///
/// Thread-safety: solve() is const and may be called from several threads at once.
class Solver {
 public:
  virtual ~Solver() = default;
  /// As given to the registry, e.g. "nlopt:LD_SLSQP".
  virtual std::string name() const = 0;
  /// Every option this back end takes, the common ones included.
  virtual std::vector<OptionInfo> options() const = 0;
  /// Empty if this back end can solve the problem; otherwise one sentence why not.
  virtual std::string explain_unsupported(const Problem& problem) const = 0;
  /// Whether it makes something of warm_start.seeds: such a back end is asked once, with all seeds
  /// and the evaluations of all polishes, where others are asked once for each seed worth it.
  virtual bool compares_starts() const { return false; }
  /// Solves from warm_start.x (empty: the middle of the bounds).
  virtual Result solve(const Problem& problem, const WarmStart& warm_start, const Options& options,
                       const StopCondition& stop) const = 0;
};

}  // namespace prospect
