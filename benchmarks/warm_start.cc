// SPDX-License-Identifier: Apache-2.0
// warm_start [--steps N] [--solver NAME,...] [WORLD...]: on consecutive problems of a mission, how
// many evaluations each back end with gradients needs from its own solution of the problem before,
// shifted in time, and how many from the middle of the bounds, for the same cost: the higher one of
// those that the two solves end at, and 1 % or 0.01 of slack. Only problems at which they end
// within that slack of each other count; the others, where they end in different minima, are
// counted apart. Of those that count, the ones on which the shifted solution is still feasible are
// summed once more. A mission is that of `nlopt`, seed 1, its first N planning steps.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/bench/solved_rule.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "benchmarks/program_options.h"
#include "engine/planner/planner.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr int kEvaluations = 300;  // of a solve, at most
constexpr SolvedRule kSameCost{0.01, 0.01};

struct Sum {
  int problems = 0;
  int warm = 0, cold = 0;                    ///< evaluations to the cost that both reach
  int warm_better = 0, warm_worse = 0;       ///< ends that differ by more than the slack
  int halved = 0;                            ///< problems on which warm took at most half as many
  int warm_feasible = 0, cold_feasible = 0;  ///< the same, where the shifted solution is feasible
};

Result solve(const Solver& solver, const Problem& problem, const WarmStart& from) {
  Options options;
  options["max_evaluations"] = kEvaluations;
  options["trace"] = 1;
  Result result = solver.solve(problem, from, options, {});
  if (result.stop == StopReason::kError) {
    throw std::runtime_error(solver.name() + ": " + result.detail);
  }
  return result;
}

int evaluations_to(const Result& result, double cost, double tolerance) {
  for (const Improvement& i : result.trace) {
    if (i.violation <= tolerance && i.cost <= cost) return i.evaluations;
  }
  return result.counters.cost_evaluations;
}

// The inputs of a plan from `stages` stages later on, the last one held; the planner's seed
// "previous" before rates and speeds are kept.
Eigen::VectorXd shifted(const Problem& problem, const Eigen::VectorXd& x, int stages) {
  const Horizon& h = problem.horizon();
  Eigen::MatrixXd inputs(h.N, h.nu());
  for (int k = 0; k < h.N; ++k) {
    const int knot = problem.knot(std::min(k + stages, h.N - 1));
    inputs.row(k) = x.segment(knot * h.nu(), h.nu()).transpose();
  }
  return problem.knots_from_inputs(inputs);
}

// last: the back end's solution of the problem before, empty if there is none.
void compare(const Solver& solver, const Problem& problem, double passed, Eigen::VectorXd& last,
             Sum& sum) {
  const double tolerance = CommonOptions().feasibility_tolerance;
  const Result cold = solve(solver, problem, {});
  const auto stages = static_cast<int>(std::lround(passed / problem.horizon().dt));
  if (last.size() == 0 || stages >= problem.horizon().N) {
    last = cold.x;
    return;
  }
  WarmStart from;
  from.x = shifted(problem, last, stages);
  const Result warm = solve(solver, problem, from);
  last = warm.x;
  if (cold.violation > tolerance || warm.violation > tolerance) return;
  const double worse = std::max(cold.cost, warm.cost);
  const double least = std::min(cold.cost, warm.cost);
  if (least < worse - kSameCost.slack(worse)) {
    ++(warm.cost < cold.cost ? sum.warm_better : sum.warm_worse);
    return;
  }
  const int n_warm = evaluations_to(warm, worse + kSameCost.slack(worse), tolerance);
  const int n_cold = evaluations_to(cold, worse + kSameCost.slack(worse), tolerance);
  ++sum.problems;
  sum.warm += n_warm;
  sum.cold += n_cold;
  sum.halved += 2 * n_warm <= n_cold;
  if (!warm.trace.empty() && warm.trace.front().violation <= tolerance) {
    sum.warm_feasible += n_warm;
    sum.cold_feasible += n_cold;
  }
}

// The algorithms behind the aliases, those with gradients, hybrid's own starts left out.
std::vector<std::string> gradient_solvers() {
  std::vector<std::string> names;
  for (const SolverInfo& info : list_solvers()) {
    if (info.available &&
        (info.name.starts_with("nlopt:LD_") || info.name == "ipopt" || info.name == "ceres")) {
      names.push_back(info.name);
    }
  }
  return names;
}

/// Solves the problem of each step from both starts.
struct Starts final : RunObserver {
  explicit Starts(const std::vector<std::shared_ptr<const Solver>>& its_solvers)
      : solvers(its_solvers) {}
  void on_step(const MissionStep& step) override {
    done = step.index + 1;
    for (const auto& solver : solvers) {
      const Problem* const problem = step.made ? step.made->problem.get() : nullptr;
      if (problem == nullptr || !solver->explain_unsupported(*problem).empty()) continue;
      compare(*solver, *problem, step.time - stamp, last[solver->name()], sums[solver->name()]);
    }
    stamp = step.time;
  }

  const std::vector<std::shared_ptr<const Solver>>& solvers;
  std::map<std::string, Sum> sums;
  std::map<std::string, Eigen::VectorXd> last;
  double stamp = 0.0;
  int done = 0;
};

int measure(const std::vector<std::string>& worlds, int steps,
            const std::vector<std::string>& names) {
  Configuration configuration = read_configuration("");
  configuration.solver = "nlopt";
  std::vector<std::shared_ptr<const Solver>> solvers;
  for (const std::string& name : names.empty() ? gradient_solvers() : names) {
    solvers.push_back(make_solver(name));
  }
  std::printf(
      "| world | back end | same end | evaluations, cold | warm | ratio | halved on | other end, "
      "warm better / worse | cold, warm start feasible | warm "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : worlds) {
    const auto world =
        std::make_shared<const World>(load_world(name, world_options_for(configuration)));
    Starts starts(solvers);
    ExplorationRunOptions options;
    options.seed = 1;
    options.keep_steps = false;
    options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&starts}; };
    options.cancelled = [&] { return starts.done >= steps; };
    run_exploration(world, configuration, options);
    for (const auto& [solver, s] : starts.sums) {
      std::printf("| %s | `%s` | %d | %d | %d | %.2f | %d | %d / %d | %d | %d |\n", name.c_str(),
                  solver.c_str(), s.problems, s.cold, s.warm,
                  static_cast<double>(s.warm) / std::max(1, s.cold), s.halved, s.warm_better,
                  s.warm_worse, s.cold_feasible, s.warm_feasible);
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  prospect::ProgramOptions options("evaluations with and without a warm start");
  int steps = 80;
  std::vector<std::string> worlds = {"office", "corridor", "loop"}, names;
  options.add("--steps", steps, "planning steps of each mission", {.least = 1, .most = 1e6});
  options.add("--solver", names, "back ends, between commas (default: all with gradients)",
              {.commas = true});
  options.add("worlds", worlds, "worlds, as `prospect explore` takes them");
  if (const std::optional<int> end = options.parse(argc, argv)) return *end;
  try {
    return prospect::measure(worlds, steps, names);
  } catch (const std::exception& e) {
    std::cerr << "warm_start: " << e.what() << '\n';
    return 2;
  }
}
