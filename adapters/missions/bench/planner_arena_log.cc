// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/planner_arena_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "models/range_text.h"
#include "models/version.h"

namespace prospect {
namespace {

constexpr std::array kStops = {StopReason::kConverged,        StopReason::kDeadline,
                               StopReason::kIterationLimit,   StopReason::kCancelled,
                               StopReason::kNumericalTrouble, StopReason::kError,
                               StopReason::kInfeasible,       StopReason::kUnbounded};

/// One word on one line, as the reader of the format splits it.
std::string word_of(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '|' || c == ';') c = '_';
  }
  return text.empty() ? "_" : text;
}

std::string field_of(double value) {
  return std::isfinite(value) ? exact_text(value) : std::string();
}

std::string text_of(const nlohmann::ordered_json& environment, const char* key,
                    const std::string& otherwise) {
  const auto found = environment.find(key);
  return found != environment.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

std::string run_of(const BenchRow& row) {
  const auto stop = std::find(kStops.begin(), kStops.end(), row.stop) - kStops.begin();
  const bool there = feasible(row);
  std::string line;
  for (const std::string& field :
       {std::to_string(row.problem), std::to_string(row.seed), std::string(row.solved ? "1" : "0"),
        std::to_string(row.supported ? stop : static_cast<long>(kStops.size())),
        row.supported ? field_of(row.seconds) : std::string(), field_of(row.seconds_to_target),
        there ? field_of(row.cost) : std::string(), field_of(row.gap), field_of(row.optimality),
        std::to_string(row.counters.cost_evaluations), field_of(row.evaluations_to_target),
        std::to_string(row.counters.gradient_evaluations)}) {
    line += field + "; ";
  }
  return line + '\n';
}

std::string progress_of(const BenchTable& table, const BenchRow& row) {
  const double best = table.best_of(row).cost;
  std::string line;
  for (const Improvement& i : row.trace) {
    if (!feasible(row) || i.violation > kFeasible || !std::isfinite(i.cost)) continue;
    line += field_of(i.seconds) + ',' + field_of(i.cost) + ',' +
            field_of(table.rule(row).gap(i.cost, best)) + ",;";
  }
  return line + '\n';
}

}  // namespace

std::string planner_arena_log(const BenchTable& table, int set, double deadline) {
  std::vector<std::vector<const BenchRow*>> by_solver(table.solvers.size());
  double seconds = 0.0;
  for (const BenchRow& row : table.rows) {
    if (row.set != set || row.deadline != deadline) continue;
    by_solver[static_cast<std::size_t>(row.solver)].push_back(&row);
    seconds += row.seconds;
  }
  const nlohmann::ordered_json environment =
      table.environments.empty() ? nlohmann::ordered_json::object() : table.environments.front();
  const ProblemSetFacts& facts = table.sets[static_cast<std::size_t>(set)];
  const std::size_t runs = by_solver.empty() ? 0 : by_solver.front().size();

  std::string log = std::string("OMPL version 1.5.2\nExperiment ") + word_of(facts.name);
  if (deadline > 0.0) log += '_' + exact_text(1e3 * deadline) + "ms";
  log += "\n2 experiment properties\nmax_evaluations INTEGER = " +
         std::to_string(table.max_evaluations) +
         "\nrelative_tolerance REAL = " + exact_text(table.relative_tolerance) +
         "\nRunning on prospect\nStarting at " +
         text_of(environment, "started", "1970-01-01 00:00:00") + "\n<<<|\nprospect " + kVersion +
         '\n';
  for (std::size_t p = 0; p < facts.problems.size(); ++p) {
    log += "problem " + std::to_string(p) + ": " + facts.problems[p].name + '\n';
  }
  log += "|>>>\n<<<|\n" + text_of(environment, "processor", "processor not known") + "\n|>>>\n" +
         std::to_string(table.seeds.front()) + " is the random seed\n" + exact_text(deadline) +
         " seconds per run\n0 MB per run\n" + std::to_string(runs) + " runs per planner\n" +
         exact_text(seconds) + " seconds spent to collect the data\n1 enum type\nstatus";
  for (const StopReason stop : kStops) log += '|' + std::string(to_string(stop));
  log += "|not supported\n" + std::to_string(table.solvers.size()) + " planners\n";
  for (std::size_t k = 0; k < table.solvers.size(); ++k) {
    log +=
        word_of(table.solvers[k]) +
        "\n0 common properties\n12 properties for each run\nproblem INTEGER\nsolver seed INTEGER\n"
        "solved BOOLEAN\nstatus ENUM\ntime REAL\ntime to target REAL\ncost REAL\ngap REAL\n"
        "optimality REAL\nevaluations INTEGER\nevaluations to target INTEGER\n"
        "gradients INTEGER\n" +
        std::to_string(by_solver[k].size()) + " runs\n";
    for (const BenchRow* row : by_solver[k]) log += run_of(*row);
    log += "3 progress properties for each run\ntime REAL\nbest cost REAL\ngap REAL\n" +
           std::to_string(by_solver[k].size()) + " runs\n";
    for (const BenchRow* row : by_solver[k]) log += progress_of(table, *row);
    log += ".\n";
  }
  return log;
}

}  // namespace prospect
