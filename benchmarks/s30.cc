// SPDX-License-Identifier: Apache-2.0
// s30 [--starts SEED] [SOLVER[,OPTION=VALUE]...]...: R1 from thirty starts, a row for each back end
// (all that are built in if none is named), each from the cold guess with its default options: the
// median of the times of a solve, J (mean, median) and how many are solved (r1.h). Of the solves of
// one start the fastest of three counts: other work on the machine only ever adds time. Other
// starts than S30 (--starts, to tune on) have no best known costs: the best of all rows counts.
//
// s30 --closed-loop [SOLVER[,OPTION=VALUE]...]...: 30 steps of a closed loop from each of the
// thirty. `hybrid` solves the first problem; each step drives the first input for dt, shifts the
// result of the last step by a stage and solves from there, the fastest of three. The row says how
// long that takes, and how much better nlopt:LD_SLSQP, with tolerance 1e-9, makes what it ends
// with.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/missions/bench/solver_choice.h"
#include "engine/support/quantile.h"
#include "problems/r1.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

constexpr int kStarts = 30;
constexpr int kRepeats = 3;
constexpr unsigned kS30Seed = 17;

struct Row {
  std::string name;
  std::vector<double> ms, J;
  double evaluations = 0.0, gradients = 0.0;  ///< mean a solve
};

/// The fastest of kRepeats solves, which have the same result; its time is added to `ms`.
Result solve(const SolverChoice& choice, const Problem& problem, const WarmStart& start,
             std::vector<double>& ms) {
  double fastest = std::numeric_limits<double>::infinity();
  Result result;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    result = choice.solver->solve(problem, start, choice.options, {});
    if (result.stop == StopReason::kError) throw std::runtime_error(result.detail);
    fastest = std::min(fastest, 1e3 * result.seconds);
  }
  ms.push_back(fastest);
  return result;
}

Row run(const SolverChoice& choice, const std::vector<Eigen::Vector3d>& starts) {
  Row row{choice.label, {}, {}};
  WarmStart cold;
  cold.x = r1_cold();
  for (const Eigen::Vector3d& x0 : starts) {
    const Result result = solve(choice, make_r1(x0), cold, row.ms);
    row.J.push_back(result.cost);
    row.evaluations += result.counters.cost_evaluations / static_cast<double>(starts.size());
    row.gradients += result.counters.gradient_evaluations / static_cast<double>(starts.size());
  }
  return row;
}

void print(const Row& row, const std::vector<double>& best) {
  int solved = 0;
  for (std::size_t i = 0; i < best.size(); ++i) solved += r1_solved(row.J[i], best[i]);
  const double mean = std::accumulate(row.J.begin(), row.J.end(), 0.0) / kStarts;
  std::printf("| `%s` | %.1f | %.1f | %.3f | %.4f | %d | %.0f | %.0f |\n", row.name.c_str(),
              quantile(row.ms, 0.5), *std::max_element(row.ms.begin(), row.ms.end()), mean,
              quantile(row.J, 0.5), solved, row.evaluations, row.gradients);
  std::fflush(stdout);
}

/// At the commas.
std::vector<std::string> split(const std::vector<std::string>& words) {
  std::vector<std::string> parts;
  for (const std::string& word : words) {
    std::istringstream list(word);
    for (std::string part; std::getline(list, part, ',');) parts.push_back(part);
  }
  return parts;
}

/// words: a back end each, options behind commas; empty: all that are built in.
int table(std::vector<std::string> words, unsigned seed) {
  if (words.empty()) {
    for (const SolverInfo& info : list_solvers()) {
      if (info.available) words.push_back(info.name);
    }
  }
  const std::vector<SolverChoice> choices = choose_solvers(split(words), {});
  const std::vector<Eigen::Vector3d> starts = r1_starts(seed, kStarts);
  std::printf(
      "| back end | ms, median | ms, worst | J, mean | J, median | solved of 30 | evaluations | of "
      "them with gradient |\n|---|---|---|---|---|---|---|---|\n");
  std::vector<double> best(s30_best_known().begin(), s30_best_known().end());
  std::vector<Row> rows;
  for (const SolverChoice& choice : choices) {
    rows.push_back(run(choice, starts));
    if (seed == kS30Seed) print(rows.back(), best);
  }
  if (seed != kS30Seed) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i] = std::numeric_limits<double>::infinity();
      for (const Row& row : rows) best[i] = std::min(best[i], row.J[i]);
    }
    for (const Row& row : rows) print(row, best);
  }
  return 0;
}

/// `by_stage`, columns of `width` a stage, a stage later; the last one stays.
template <typename Matrix>
void shift(Matrix& by_stage, Eigen::Index width) {
  const Eigen::Index n = by_stage.size() - width;
  if (n <= 0) return;
  std::copy_n(by_stage.data() + width, n, by_stage.data());
}

int closed_loop(const std::vector<std::string>& words) {
  constexpr int kSteps = 30;
  std::printf(
      "| back end | ms a step, median | p99 | worst | evaluations | gain left, median | p90 |\n"
      "|---|---|---|---|---|---|---|\n");
  const auto exact = make_solver("nlopt:LD_SLSQP");
  for (const SolverChoice& choice : choose_solvers(split(words), {})) {
    std::vector<double> ms, left;
    double evaluations = 0.0;
    for (Eigen::Vector3d x0 : r1_starts(kS30Seed, kStarts)) {
      WarmStart warm;
      warm.x = r1_cold();
      warm.x = make_solver("hybrid")->solve(make_r1(x0), warm, {}, {}).x;
      for (int step = 0; step < kSteps; ++step) {
        const Problem here = make_r1(x0);
        Workspace workspace = here.make_workspace();
        Evaluation e;
        here.evaluate(warm.x, Evaluate::kStages, workspace, e);
        x0 = e.stages.states.col(1);
        const Problem problem = make_r1(x0);
        shift(warm.x, problem.horizon().nu());
        shift(warm.stage_hessians, 9);
        const Result result = solve(choice, problem, warm, ms);
        evaluations += result.counters.cost_evaluations;
        warm = result.next;
        warm.x = result.x;
        left.push_back(result.cost - exact->solve(problem, warm, {{"tolerance", 1e-9}}, {}).cost);
      }
    }
    std::printf("| `%s` | %.3f | %.3f | %.3f | %.1f | %.2g | %.2g |\n", choice.label.c_str(),
                quantile(ms, 0.5), quantile(ms, 0.99), *std::max_element(ms.begin(), ms.end()),
                evaluations / static_cast<double>(ms.size()), quantile(left, 0.5),
                quantile(left, 0.9));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace prospect

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  unsigned seed = prospect::kS30Seed;
  try {
    if (words.size() >= 2 && words[0] == "--starts") {
      seed = static_cast<unsigned>(std::stoul(words[1]));
      words.erase(words.begin(), words.begin() + 2);
    }
    if (words.size() >= 2 && words[0] == "--closed-loop") {
      return prospect::closed_loop({words.begin() + 1, words.end()});
    }
    return prospect::table(words, seed);
  } catch (const std::exception& e) {
    std::cerr << "s30: " << e.what() << '\n';
    return 2;
  }
}
