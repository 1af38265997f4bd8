// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_run.h"

#include <stdlib.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "adapters/missions/bench/stated_bounds.h"
#include "solvers/first_order_residual.h"
#include "solvers/judge.h"
#include "solvers/problem_scale.h"

namespace prospect {
namespace {

double machine_load() {
  double load = 0.0;
  return getloadavg(&load, 1) == 1 ? load : std::numeric_limits<double>::quiet_NaN();
}

/// Of x, by us; NaN where a term throws.
double measured_residual(const Problem& problem, const Eigen::VectorXd& x) {
  try {
    return first_order_residual(problem, x, kFeasible);
  } catch (...) {
    // A term that throws here has thrown in the solve, which says so.
    return std::numeric_limits<double>::quiet_NaN();
  }
}

/// So that the first back end does not pay for what the caches lack.
void fill_caches(const BenchProblem& problem) {
  try {
    if (problem.start.x.size() > 0) problem.problem->explain(problem.start.x);
  } catch (...) {
    // A term that throws: each back end says so.
  }
}

BenchRow solve_once(const BenchProblem& problem, const SolverChoice& choice, double limit, int seed,
                    const BenchOptions& options) {
  // A back end from elsewhere may lack an option that all of ours have.
  Options given = choice.options;
  for (const OptionInfo& info : choice.solver->options()) {
    if (info.name == "max_evaluations") given.emplace(info.name, options.max_evaluations);
    if (info.name == "seed") given.emplace(info.name, seed);
    if (info.name == "trace") given[info.name] = 1;
  }
  const double wall = seconds_by(SolveClock::kWall);
  const double processor = seconds_by(SolveClock::kProcessor);
  StopCondition stop = deadline(limit > 0.0 ? limit : StopCondition::kNever, options.clock);
  if (options.cancelled) stop = stop || cancelled_by(options.cancelled);
  StatedBoundsSolve solve = solve_within_stated_bounds(problem, *choice.solver, given, stop);
  Result& result = solve.result;

  BenchRow row;
  row.wall_seconds = seconds_by(SolveClock::kWall) - wall;
  row.processor_seconds = seconds_by(SolveClock::kProcessor) - processor;
  row.seconds = options.clock == SolveClock::kWall ? row.wall_seconds : row.processor_seconds;
  row.deadline = limit;
  row.seed = seed;
  row.stop = result.stop;
  row.claimed = row.quality = result.quality;
  row.held = solve.held;
  if (result.quality != Quality::kNone) {
    row.optimality = measured_residual(*solve.within, result.x);
    if (result.quality == Quality::kFeasibleOptimum &&
        judge(*solve.within, result.x).verdict != Judgement::Verdict::kOptimum) {
      row.quality = Quality::kFeasible;
    }
    row.x = std::move(result.x);
  }
  row.cost = result.cost;
  row.violation = result.violation;
  row.counters = result.counters;
  if (limit > 0.0) row.overrun = std::max(0.0, row.seconds - limit);
  row.trace = std::move(result.trace);
  if (row.trace.empty() && row.quality != Quality::kNone) {
    row.trace = {{row.seconds, row.counters.cost_evaluations, row.cost, row.violation}};
  }
  row.detail = std::move(result.detail);
  return row;
}

bool usable(const BenchRow& row) {
  return row.supported && row.stop != StopReason::kError && row.quality != Quality::kNone;
}

bool better(const BenchRow& a, const BenchRow& b) {
  if (usable(a) != usable(b)) return usable(a);
  if (feasible(a) != feasible(b)) return feasible(a);
  return feasible(a) ? a.cost < b.cost : a.violation < b.violation;
}

ProblemFacts facts_of(const BenchProblem& problem) {
  const Problem& p = *problem.problem;
  ProblemFacts facts{problem.name, p.num_variables(), p.num_constraints(),
                     problem_fingerprint(problem), problem.best_known};
  const Eigen::VectorXd start =
      problem.start.x.size() == p.num_variables()
          ? Eigen::VectorXd(problem.start.x.cwiseMax(p.lower()).cwiseMin(p.upper()))
          : Eigen::VectorXd(0.5 * (p.lower() + p.upper()));
  try {
    Workspace workspace = p.make_workspace();
    const EvaluatePoint evaluate = [&](const Eigen::VectorXd& z, Evaluate what, Evaluation& e) {
      p.evaluate(z, what, workspace, e);
      return is_usable(e, what) ? EvaluationOutcome::kEvaluated : EvaluationOutcome::kRejected;
    };
    Evaluation e;
    if (evaluate(start, Evaluate::kValue, e) == EvaluationOutcome::kEvaluated &&
        violation(e.constraints.col(0)) <= kFeasible) {
      facts.start_cost = e.cost[0];
    }
    facts.cost_change = cost_change_near(p, start, evaluate);
    // A start that cannot be evaluated: on the way to the bounds.
    for (const double share : {0.5, 0.25, 0.75, 0.1, 0.9}) {
      if (facts.cost_change > 0.0) break;
      const Eigen::VectorXd x = p.lower() + share * (p.upper() - p.lower());
      facts.cost_change = cost_change_near(p, x, evaluate);
    }
  } catch (...) {
    // A term that throws: each back end says so.
  }
  return facts;
}

/// The row that stands for the repeats, see BenchRow.
BenchRow representative(std::vector<BenchRow> repeats) {
  double overrun = 0.0;
  std::vector<double> seconds;
  for (const BenchRow& row : repeats) {
    overrun = std::max(overrun, row.overrun);
    seconds.push_back(row.seconds);
  }
  if (repeats.front().deadline > 0.0) {
    std::stable_sort(repeats.begin(), repeats.end(), better);
  } else {
    std::stable_sort(repeats.begin(), repeats.end(),
                     [](const BenchRow& a, const BenchRow& b) { return a.seconds < b.seconds; });
  }
  const std::size_t chosen = repeats.front().deadline > 0.0 ? repeats.size() / 2 : 0;
  BenchRow row = std::move(repeats[chosen]);
  row.overrun = overrun;
  row.repeat_seconds = std::move(seconds);
  return row;
}

/// Leaves the problems before that one.
void keep_done(BenchTable& table, std::size_t set, std::size_t problem) {
  table.cancelled = true;
  std::erase_if(table.rows, [&](const BenchRow& row) {
    const auto s = static_cast<std::size_t>(row.set), p = static_cast<std::size_t>(row.problem);
    return s > set || (s == set && p >= problem);
  });
  std::vector<ProblemFacts>& problems = table.sets[set].problems;
  problems.erase(problems.begin() + static_cast<std::ptrdiff_t>(problem), problems.end());
  const std::size_t whole = set + (problem > 0 ? 1 : 0);
  table.sets.erase(table.sets.begin() + static_cast<std::ptrdiff_t>(whole), table.sets.end());
}

}  // namespace

BenchTable empty_bench(const std::vector<ProblemSet>& sets,
                       const std::vector<SolverChoice>& solvers, const BenchOptions& options) {
  BenchTable table;
  for (const ProblemSet& set : sets) {
    ProblemSetFacts facts{set.name, set.best_known_source, set.absolute_tolerance, {}};
    for (const BenchProblem& problem : set.problems) {
      facts.problems.push_back(facts_of(problem));
    }
    table.sets.push_back(std::move(facts));
  }
  for (const SolverChoice& choice : solvers) table.solvers.push_back(choice.label);
  table.deadlines = options.deadlines;
  table.seeds = options.seeds;
  table.repeats = options.repeats;
  table.max_evaluations = options.max_evaluations;
  table.relative_tolerance = options.relative_tolerance;
  table.clock = options.clock;
  table.environments = {options.environment};
  return table;
}

BenchTable run_bench(const std::vector<ProblemSet>& sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options, BenchTable table) {
  using Key = std::tuple<int, int, double, int, int>;
  const auto key_of = [](const BenchRow& row) {
    return Key(row.set, row.problem, row.deadline, row.seed, row.solver);
  };
  std::map<Key, bool> there;
  for (const BenchRow& row : table.rows) there[key_of(row)] = true;

  const int environment = environment_index(table, options.environment);
  std::size_t problems = 0;
  for (const ProblemSet& set : sets) problems += set.problems.size();
  const std::size_t cells =
      problems * solvers.size() * options.deadlines.size() * options.seeds.size();
  const int all = static_cast<int>(cells - table.rows.size()) * options.repeats;
  int done = 0;
  const auto cancelled = [&] { return options.cancelled && options.cancelled(); };

  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (std::size_t p = 0; p < sets[s].problems.size(); ++p) {
      const BenchProblem& problem = sets[s].problems[p];
      fill_caches(problem);
      for (const double limit : options.deadlines) {
        for (const int seed : options.seeds) {
          for (std::size_t k = 0; k < solvers.size(); ++k) {
            BenchRow row;
            row.set = static_cast<int>(s);
            row.problem = static_cast<int>(p);
            row.solver = static_cast<int>(k);
            row.deadline = limit;
            row.seed = seed;
            if (there.contains(key_of(row))) continue;
            row.detail = solvers[k].solver->explain_unsupported(*problem.problem);
            row.supported = row.detail.empty();
            if (row.supported) {
              std::vector<BenchRow> repeats;
              for (int i = 0; i < options.repeats; ++i) {
                if (cancelled()) break;
                repeats.push_back(solve_once(problem, solvers[k], limit, seed, options));
                if (options.on_solve) options.on_solve(++done, all);
              }
              if (cancelled()) {
                keep_done(table, s, p);
                sort_rows(table);
                judge(table);
                return table;
              }
              BenchRow chosen = representative(std::move(repeats));
              chosen.set = row.set;
              chosen.problem = row.problem;
              chosen.solver = row.solver;
              row = std::move(chosen);
            } else {
              done += options.repeats;
            }
            row.environment = environment;
            row.load = machine_load();
            table.rows.push_back(std::move(row));
            if (options.on_row) options.on_row(table, table.rows.back());
          }
        }
      }
    }
  }
  sort_rows(table);
  judge(table);
  return table;
}

BenchTable run_bench(const std::vector<ProblemSet>& sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options) {
  return run_bench(sets, solvers, options, empty_bench(sets, solvers, options));
}

}  // namespace prospect
