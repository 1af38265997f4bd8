// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/candidate_polish.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <optional>
#include <utility>

#include "engine/problem/admissible_inputs.h"

namespace prospect {
namespace {

// Ends of trajectories nearer than both are in one basin.
constexpr double kBasinDistance = 0.4;  // [m]
constexpr double kBasinTurn = 0.5;      // [rad]

/// The solver's result from one start; of quality kNone if there is none.
Result solve(const Solver& solver, const PolishOptions& settings,
             const CandidateEvaluation& evaluation, const WarmStart& warm, int evaluations,
             const StopCondition& stop) {
  Options options = settings.solver_options;
  options.try_emplace("max_evaluations", evaluations);
  if (settings.shares_threads) options.try_emplace("threads", evaluation.threads);
  Result result;
  try {
    result = solver.solve(evaluation.problem, warm, options, stop);
  } catch (const std::exception& e) {
    result.detail = std::string("the solver threw: ") + e.what();
  } catch (...) {
    result.detail = "the solver threw";
  }
  return result;
}

/// All candidates as starts of one solve.
WarmStart starts_of(const std::vector<Candidate>& candidates) {
  const auto others = static_cast<Eigen::Index>(candidates.size()) - 1;
  WarmStart warm;
  warm.x = candidates.front().z;
  warm.seeds.resize(warm.x.size(), others);
  for (Eigen::Index i = 0; i < others; ++i) {
    warm.seeds.col(i) = candidates[static_cast<std::size_t>(i) + 1].z;
  }
  return warm;
}

/// The best `count` in basins apart: seeds that end near each other usually polish to the same
/// plan.
std::vector<const Candidate*> basins_apart(const std::vector<Candidate>& candidates, int count,
                                           const Problem& problem) {
  std::vector<const Candidate*> chosen;
  std::vector<Pose> ends;
  for (const Candidate& seed : candidates) {
    if (static_cast<int>(chosen.size()) >= count) break;
    const TrajectoryBatch t = problem.rollout(seed.z);
    const Pose end = t.pose(t.horizon.N, 0);
    const bool known_basin = std::any_of(ends.begin(), ends.end(), [&](const Pose& other) {
      return (other.position - end.position).norm() < kBasinDistance &&
             std::abs(std::remainder(other.yaw - end.yaw, 2.0 * M_PI)) < kBasinTurn;
    });
    if (known_basin) continue;
    chosen.push_back(&seed);
    ends.push_back(end);
  }
  return chosen;
}

/// Evaluates those scored candidates exactly that may be better than the best exact one.
void evaluate_leading(std::vector<Candidate>& candidates, const CandidateEvaluation& evaluation) {
  const auto known = std::find_if(candidates.begin(), candidates.end(),
                                  [](const Candidate& c) { return c.error == 0.0; });
  std::optional<Candidate> best;
  if (known != candidates.end()) best = *known;
  const auto open = [&](const Candidate& c) {
    if (c.error == 0.0) return false;
    Candidate least;
    least.cost = c.cost - c.error;
    least.violation = c.violation;
    return !best || !(*best < least);
  };
  std::vector<Candidate> leading;
  for (const Candidate& c : candidates) {
    if (open(c)) leading.push_back(c);
  }
  leading = evaluate(std::move(leading), Evaluate::kValue, evaluation);
  std::erase_if(candidates, open);
  candidates.insert(candidates.begin(), std::make_move_iterator(leading.begin()),
                    std::make_move_iterator(leading.end()));
  std::stable_sort(candidates.begin(), candidates.end());
}

}  // namespace

bool shares_threads(const Solver& solver) {
  if (!solver.compares_starts()) return false;
  const std::vector<OptionInfo> known = solver.options();
  return std::any_of(known.begin(), known.end(),
                     [](const OptionInfo& o) { return o.name == "threads"; });
}

PolishOutcome polish(std::vector<Candidate>& candidates, const Solver& solver,
                     const PolishOptions& options, const CandidateEvaluation& evaluation,
                     const StopCondition& stop) {
  const Problem& problem = evaluation.problem;
  PolishOutcome outcome;
  std::vector<Candidate> polished;
  const auto take = [&](const Candidate& seed, Result result) {
    outcome.counters.cost_evaluations += result.counters.cost_evaluations;
    outcome.counters.gradient_evaluations += result.counters.gradient_evaluations;
    outcome.counters.iterations += result.counters.iterations;
    outcome.stop = result.stop;
    if (result.stop == StopReason::kError) outcome.error = result.detail;
    if (result.quality == Quality::kNone || result.x.size() != problem.num_variables() ||
        !result.x.allFinite()) {
      return;
    }
    Candidate c{seed.name, admissible_inputs(problem, result.x), result.cost, result.violation,
                std::move(result)};
    c.stops = seed.stops;
    polished.push_back(std::move(c));
  };

  if (solver.compares_starts() && !candidates.empty() && options.polished > 0) {
    // It scores the seeds itself: those evaluations are no polish.
    const int evaluations =
        options.polished * options.evaluations + static_cast<int>(candidates.size());
    take(candidates.front(),
         solve(solver, options, evaluation, starts_of(candidates), evaluations, stop));
  } else {
    const std::vector<const Candidate*> chosen =
        basins_apart(candidates, options.polished, problem);
    const StopCondition asked = one_at_a_time(stop);
    std::vector<std::optional<Result>> results(chosen.size());
    evaluation.workers.run(static_cast<int>(chosen.size()), [&](int k) {
      const auto at = static_cast<std::size_t>(k);
      if (asked() != StopRequest::kNone) return;
      WarmStart warm;
      warm.x = chosen[at]->z;
      results[at] = solve(solver, options, evaluation, warm, options.evaluations, asked);
    });
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (results[k]) take(*chosen[k], std::move(*results[k]));
    }
  }
  polished = evaluate(std::move(polished), Evaluate::kValue, evaluation);
  candidates.insert(candidates.end(), std::make_move_iterator(polished.begin()),
                    std::make_move_iterator(polished.end()));
  std::stable_sort(candidates.begin(), candidates.end());
  if (stop() == StopRequest::kNone) evaluate_leading(candidates, evaluation);
  return outcome;
}

}  // namespace prospect
