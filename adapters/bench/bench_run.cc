#include "adapters/bench/bench_run.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace prospect {
namespace {

using WallClock = std::chrono::steady_clock;

BenchRow solve_once(const BenchProblem& problem, const SolverChoice& choice, double limit,
                    const BenchOptions& options) {
  // A back end from elsewhere may lack an option that all of ours have.
  Options given = choice.options;
  for (const OptionInfo& info : choice.solver->options()) {
    if (info.name == "max_evaluations") given.emplace(info.name, options.max_evaluations);
    if (info.name == "seed") given.emplace(info.name, options.seed);
    if (info.name == "trace") given[info.name] = 1;
  }
  const auto begin = WallClock::now();
  StopCondition stop = limit > 0.0 ? deadline(limit) : StopCondition();
  if (options.cancelled) stop = stop || cancelled_by(options.cancelled);
  Result result = choice.solver->solve(*problem.problem, problem.start, given, stop);
  const double seconds = std::chrono::duration<double>(WallClock::now() - begin).count();

  BenchRow row;
  row.deadline = limit;
  row.stop = result.stop;
  row.quality = result.quality;
  row.cost = result.cost;
  row.violation = result.violation;
  row.counters = result.counters;
  row.seconds = seconds;
  if (limit > 0.0) row.overrun = std::max(0.0, seconds - limit);
  row.trace = std::move(result.trace);
  if (row.trace.empty() && row.quality != Quality::kNone) {
    row.trace = {{seconds, row.counters.cost_evaluations, row.cost, row.violation}};
  }
  row.detail = std::move(result.detail);
  return row;
}

bool usable(const BenchRow& row) {
  return row.supported && row.stop != StopReason::kError && row.quality != Quality::kNone;
}

bool feasible(const BenchRow& row) { return usable(row) && row.violation <= kFeasible; }

bool better(const BenchRow& a, const BenchRow& b) {
  if (usable(a) != usable(b)) return usable(a);
  if (feasible(a) != feasible(b)) return feasible(a);
  return feasible(a) ? a.cost < b.cost : a.violation < b.violation;
}

/// The row that stands for the repeats, see BenchRow.
BenchRow representative(std::vector<BenchRow> repeats) {
  double overrun = 0.0;
  for (const BenchRow& row : repeats) overrun = std::max(overrun, row.overrun);
  if (repeats.front().deadline > 0.0) {
    std::stable_sort(repeats.begin(), repeats.end(), better);
  } else {
    std::stable_sort(repeats.begin(), repeats.end(),
                     [](const BenchRow& a, const BenchRow& b) { return a.seconds < b.seconds; });
  }
  const std::size_t chosen = repeats.front().deadline > 0.0 ? repeats.size() / 2 : 0;
  BenchRow row = std::move(repeats[chosen]);
  row.overrun = overrun;
  return row;
}

/// Leaves the problems before that one.
void keep_done(BenchTable& table, std::size_t set, std::size_t problem) {
  table.cancelled = true;
  std::erase_if(table.rows, [&](const BenchRow& row) {
    return static_cast<std::size_t>(row.set) == set &&
           static_cast<std::size_t>(row.problem) == problem;
  });
  std::vector<BenchProblem>& problems = table.sets[set].problems;
  problems.erase(problems.begin() + static_cast<std::ptrdiff_t>(problem), problems.end());
  const std::size_t whole = set + (problem > 0 ? 1 : 0);
  table.sets.erase(table.sets.begin() + static_cast<std::ptrdiff_t>(whole), table.sets.end());
}

}  // namespace

BenchTable run_bench(std::vector<ProblemSet> sets, const std::vector<SolverChoice>& solvers,
                     const BenchOptions& options) {
  BenchTable table;
  table.options = options;
  table.sets = std::move(sets);
  for (const SolverChoice& choice : solvers) table.solvers.push_back(choice.label);
  std::size_t problems = 0;
  for (const ProblemSet& set : table.sets) problems += set.problems.size();
  const int all =
      static_cast<int>(problems * solvers.size() * options.deadlines.size()) * options.repeats;
  int done = 0;
  const auto cancelled = [&] { return options.cancelled && options.cancelled(); };

  for (std::size_t s = 0; s < table.sets.size(); ++s) {
    for (std::size_t p = 0; p < table.sets[s].problems.size(); ++p) {
      const BenchProblem& problem = table.sets[s].problems[p];
      // So that the first back end does not pay for what the caches lack.
      if (problem.start.x.size() > 0) problem.problem->explain(problem.start.x);
      for (const double limit : options.deadlines) {
        for (std::size_t k = 0; k < solvers.size(); ++k) {
          BenchRow row;
          row.detail = solvers[k].solver->explain_unsupported(*problem.problem);
          row.supported = row.detail.empty();
          row.deadline = limit;
          if (row.supported) {
            std::vector<BenchRow> repeats;
            for (int i = 0; i < options.repeats; ++i) {
              if (cancelled()) break;
              repeats.push_back(solve_once(problem, solvers[k], limit, options));
              if (options.on_solve) options.on_solve(++done, all);
            }
            if (cancelled()) {
              keep_done(table, s, p);
              judge(table);
              return table;
            }
            row = representative(std::move(repeats));
          } else {
            done += options.repeats;
          }
          row.set = static_cast<int>(s);
          row.problem = static_cast<int>(p);
          row.solver = static_cast<int>(k);
          table.rows.push_back(std::move(row));
        }
      }
    }
  }
  judge(table);
  return table;
}

void judge(BenchTable& table) {
  table.best.clear();
  for (const ProblemSet& set : table.sets) {
    std::vector<BestKnown> best(set.problems.size());
    for (std::size_t p = 0; p < best.size(); ++p) {
      if (set.problems[p].best_known) best[p] = {*set.problems[p].best_known, "stored"};
    }
    table.best.push_back(std::move(best));
  }
  const auto best_of = [&](const BenchRow& row) -> BestKnown& {
    return table.best[static_cast<std::size_t>(row.set)][static_cast<std::size_t>(row.problem)];
  };
  for (const BenchRow& row : table.rows) {
    if (feasible(row) && row.cost < best_of(row).cost) {
      best_of(row) = {row.cost, table.solvers[static_cast<std::size_t>(row.solver)]};
    }
  }
  for (BenchRow& row : table.rows) {
    if (!feasible(row)) continue;
    const double best = best_of(row).cost;
    const SolvedRule rule = table.rule(row.set);
    row.solved = rule.solved(row.cost, row.violation, best);
    row.gap = rule.gap(row.cost, best);
    for (const Improvement& i : row.trace) {
      if (!rule.solved(i.cost, i.violation, best)) continue;
      row.seconds_to_target = i.seconds;
      row.evaluations_to_target = i.evaluations;
      break;
    }
  }
}

}  // namespace prospect
