// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/bench/solved_rule.h"
#include "engine/problem/solver.h"

namespace prospect {

/// A problem of a bench, as far as its results need it.
struct ProblemFacts {
  std::string name;  ///< unique within its set
  int variables = 0, constraints = 0;
  /// problem_fingerprint() of problem_set.h: two benches with the same one solve the same problem.
  std::string fingerprint;
  std::optional<double> best_known;  ///< before the run
  /// Of the point where back ends start, if it is feasible; NaN: not known.
  double start_cost = std::numeric_limits<double>::quiet_NaN();
  double cost_change = 0.0;  ///< cost_change_near() the start

  /// SolvedRule::difference: |start_cost - best|, or cost_change, if that is more.
  double difference(double best) const;
};

struct ProblemSetFacts {
  std::string name;
  std::string best_known_source;     ///< where best_known is from, in words; empty: from nowhere
  double absolute_tolerance = 1e-3;  ///< of SolvedRule; 0: its costs have no unit that is known
  std::vector<ProblemFacts> problems;
};

/// One cell of the table: a problem, a back end, a deadline, a seed. Of the repeats of a solve the
/// row is
///  * without a deadline the fastest: all give the same bits, and other work on the machine only
///    ever adds time;
///  * with a deadline the one of median result (feasible before infeasible, then by cost or
///    violation; of two middle ones the worse), with all its numbers.
struct BenchRow {
  int set = 0, problem = 0, solver = 0;  ///< indices
  double deadline = 0.0;                 ///< [s]; 0: none
  int seed = 1;
  int environment = 0;    ///< index: where it was measured
  double load = 0.0;      ///< of the machine, mean of the last minute; NaN: not known
  bool supported = true;  ///< false: the back end cannot solve this problem
  bool held = false;      ///< by a bound that nobody stated: x is no solution of the problem
  StopReason stop = StopReason::kError;
  Quality claimed = Quality::kNone;  ///< by the back end
  Quality quality = Quality::kNone;  ///< of the claim, judged (judge.h)
  /// first_order_residual() of x, measured after the solve; NaN: not known.
  double optimality = std::numeric_limits<double>::quiet_NaN();
  double cost = Problem::kRejectedCost;
  double violation = Problem::kRejectedCost;
  Eigen::VectorXd x;  ///< the solution; empty: none
  Counters counters;
  double seconds = 0.0;  ///< of the call of solve(), as its caller sees it, by the bench's clock
  std::vector<double> repeat_seconds;  ///< of each repeat, likewise
  /// Of the same call: by the wall's clock, and processor time of all threads.
  double wall_seconds = 0.0, processor_seconds = 0.0;
  /// The longest time past the deadline of all repeats. [s]
  double overrun = 0.0;
  std::vector<Improvement> trace;  ///< of a back end that keeps none: the result alone
  std::string detail;

  // Against the best known.
  bool solved = false;
  double gap = std::numeric_limits<double>::infinity();  ///< SolvedRule::gap; infinite: infeasible
  /// To the first point that counts as solved; infinite if there is none. [s], [-]
  double seconds_to_target = std::numeric_limits<double>::infinity();
  double evaluations_to_target = std::numeric_limits<double>::infinity();
};

/// Whether the back end came to a feasible point, and to no error.
bool feasible(const BenchRow& row);

/// What is known of a problem after the run.
struct BestKnown {
  double cost = std::numeric_limits<double>::infinity();  ///< infinite: no feasible point
  std::string found_by;  ///< "stored", or the label of the back end that beat it
};

/// The results of a bench. They need neither the problems nor the back ends.
struct BenchTable {
  std::vector<ProblemSetFacts> sets;
  std::vector<std::string> solvers;          ///< labels
  std::vector<double> deadlines = {0.0};     ///< [s]; 0: none
  std::vector<int> seeds = {1};              ///< of the back ends
  int repeats = 1;                           ///< of each solve
  int max_evaluations = 10000;               ///< of each solve, unless a back end is told otherwise
  double relative_tolerance = 0.01;          ///< of SolvedRule
  SolveClock clock = SolveClock::kWall;      ///< of deadlines and of all times
  std::vector<std::vector<BestKnown>> best;  ///< by set, problem
  std::vector<BenchRow> rows;                ///< by set, problem, deadline, seed, solver
  /// Then sets and rows hold only the problems that every back end was done with.
  bool cancelled = false;
  /// What measured: the program, its libraries and the machine. Objects.
  std::vector<nlohmann::ordered_json> environments;

  SolvedRule rule(const BenchRow& row) const {
    return {relative_tolerance, set_of(row).absolute_tolerance,
            problem_of(row).difference(best_of(row).cost)};
  }
  const ProblemSetFacts& set_of(const BenchRow& row) const {
    return sets[static_cast<std::size_t>(row.set)];
  }
  const ProblemFacts& problem_of(const BenchRow& row) const {
    return set_of(row).problems[static_cast<std::size_t>(row.problem)];
  }
  const std::string& solver_of(const BenchRow& row) const {
    return solvers[static_cast<std::size_t>(row.solver)];
  }
  const BestKnown& best_of(const BenchRow& row) const {
    return best[static_cast<std::size_t>(row.set)][static_cast<std::size_t>(row.problem)];
  }
};

/// The set, problem, back end, deadline and seed of a row in words, for a message.
std::string words_of(const BenchTable& table, const BenchRow& row);

/// Where that environment stands in the table; added at the end if it is new.
int environment_index(BenchTable& table, const nlohmann::ordered_json& environment);

/// "wall" or "cpu".
std::string to_string(SolveClock clock);

/// Share of the wall's time of all solves in which their thread did not run,
/// max(0, 1 - sum processor / sum wall): other work had the processor. Back ends with several
/// threads hide it. 0 without a solve.
double waited(const BenchTable& table);
/// With more than that, times by the wall's clock are those of a busy machine.
inline constexpr double kMostWaited = 0.05;
/// That in a sentence; "" of a machine that was not busy.
std::string busy_sentence(const BenchTable& table);

/// Fills best and what rows hold against it: the best known cost of a problem is the best of what
/// the set states and of every feasible result in the table.
void judge(BenchTable& table);

/// Brings rows into the order of BenchTable::rows.
void sort_rows(BenchTable& table);

}  // namespace prospect
