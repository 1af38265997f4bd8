#include "adapters/bench/bench_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "adapters/bench/bench_page.h"
#include "adapters/files/csv.h"
#include "adapters/files/input_error.h"
#include "adapters/files/whole_file.h"
#include "models/range_text.h"
#include "models/version.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// JSON has no infinity: null.

std::string text(double value) { return std::isfinite(value) ? exact_text(value) : std::string(); }

const BestKnown& best_of(const BenchTable& table, const BenchRow& row) {
  return table.best[static_cast<std::size_t>(row.set)][static_cast<std::size_t>(row.problem)];
}

const ProblemSet& set_of(const BenchTable& table, const BenchRow& row) {
  return table.sets[static_cast<std::size_t>(row.set)];
}

const BenchProblem& problem_of(const BenchTable& table, const BenchRow& row) {
  return set_of(table, row).problems[static_cast<std::size_t>(row.problem)];
}

const std::string& solver_of(const BenchTable& table, const BenchRow& row) {
  return table.solvers[static_cast<std::size_t>(row.solver)];
}

bool ended_somewhere(const BenchRow& row) { return row.supported && row.quality != Quality::kNone; }

std::string stop_of(const BenchRow& row) {
  return row.supported ? std::string(to_string(row.stop)) : "not supported";
}

Json trace_json(const BenchRow& row) {
  Json seconds = Json::array(), evaluations = Json::array(), costs = Json::array(),
       violations = Json::array();
  const Improvement* kept = nullptr;
  for (const Improvement& i : row.trace) {
    const bool last = &i == &row.trace.back();
    const bool changed = !kept || (kept->violation > kFeasible) != (i.violation > kFeasible);
    const double left = kept ? (kept->violation > kFeasible ? kept->violation - row.violation
                                                            : kept->cost - row.cost)
                             : 0.0;
    const double gained =
        kept ? (kept->violation > kFeasible ? kept->violation - i.violation : kept->cost - i.cost)
             : 0.0;
    if (!last && !changed && gained < 0.05 * left) continue;
    kept = &i;
    seconds.push_back(i.seconds);
    evaluations.push_back(i.evaluations);
    costs.push_back(i.cost);
    violations.push_back(i.violation);
  }
  return {{"seconds", seconds},
          {"evaluations", evaluations},
          {"cost", costs},
          {"violation", violations}};
}

Json profile_json(const PerformanceProfile& profile) {
  Json ratios = Json::array(), shares = Json::array();
  for (const PerformanceProfile::Step& step : profile.steps) {
    ratios.push_back(step.ratio);
    shares.push_back(step.share);
  }
  return {{"ratio", ratios}, {"share", shares}};
}

Json curve_json(const GapCurve& curve, const char* axis) {
  Json at = Json::array(), lower = Json::array(), median = Json::array(), upper = Json::array();
  for (const GapCurve::Point& point : curve.points) {
    at.push_back(point.at);
    lower.push_back(point.lower);
    median.push_back(point.median);
    upper.push_back(point.upper);
  }
  return {{axis, at}, {"lower", lower}, {"median", median}, {"upper", upper}};
}

Json summary_json(const SolverSummary& s) {
  return {{"solver", s.solver},
          {"problems", s.problems},
          {"solved", s.solved},
          {"feasible", s.feasible},
          {"refused", s.refused},
          {"errors", s.errors},
          {"ms_to_target",
           {{"median", s.ms_to_target_median},
            {"p90", s.ms_to_target_p90},
            {"p99", s.ms_to_target_p99}}},
          {"evaluations_to_target_median", s.evaluations_to_target_median},
          {"ms", {{"median", s.ms_median}, {"p90", s.ms_p90}, {"p99", s.ms_p99}}},
          {"evaluations_median", s.evaluations_median},
          {"gradients_median", s.gradients_median},
          {"gap_median", s.gap_median},
          {"overrun_ms",
           {{"p50", s.overrun_ms_p50}, {"p99", s.overrun_ms_p99}, {"max", s.overrun_ms_max}}},
          {"profile_by_time", profile_json(s.by_time)},
          {"profile_by_evaluations", profile_json(s.by_evaluations)},
          {"gap_over_time", curve_json(s.over_time, "seconds")},
          {"gap_over_evaluations", curve_json(s.over_evaluations, "evaluations")}};
}

Json row_json(const BenchTable& table, const BenchRow& row, bool traces) {
  const bool there = ended_somewhere(row);
  Json json = {{"set", set_of(table, row).name},
               {"problem", problem_of(table, row).name},
               {"solver", solver_of(table, row)},
               {"deadline_s", row.deadline},
               {"cost", there ? Json(row.cost) : Json(nullptr)},
               {"violation", there ? Json(row.violation) : Json(nullptr)},
               {"gap", row.gap},
               {"solved", row.solved},
               {"ms_to_target", 1e3 * row.seconds_to_target},
               {"evaluations_to_target", row.evaluations_to_target},
               {"wall_ms", 1e3 * row.seconds},
               {"overrun_ms", 1e3 * row.overrun},
               {"cost_evaluations", row.counters.cost_evaluations},
               {"gradient_evaluations", row.counters.gradient_evaluations},
               {"iterations", row.counters.iterations},
               {"stop_reason", stop_of(row)},
               {"quality", to_string(row.quality)},
               {"detail", row.detail}};
  if (traces) json["trace"] = trace_json(row);
  return json;
}

/// "12.3", "–" for what is not there.
std::string cell(double value, const char* format) {
  if (!std::isfinite(value)) return "-";
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

}  // namespace

std::string bench_csv(const BenchTable& table) {
  std::string csv =
      "set,problem,variables,constraints,solver,deadline_s,cost,violation,best_known,gap,solved,"
      "ms_to_target,evaluations_to_target,wall_ms,overrun_ms,cost_evaluations,"
      "gradient_evaluations,iterations,stop_reason,quality,detail\n";
  for (const BenchRow& row : table.rows) {
    const BenchProblem& problem = problem_of(table, row);
    const bool there = ended_somewhere(row);
    csv += csv::field(set_of(table, row).name) + ',' + csv::field(problem.name) + ',' +
           std::to_string(problem.problem->num_variables()) + ',' +
           std::to_string(problem.problem->num_constraints()) + ',' +
           csv::field(solver_of(table, row)) + ',' +
           (row.deadline > 0.0 ? exact_text(row.deadline) : std::string()) + ',' +
           (there ? text(row.cost) : "") + ',' + (there ? text(row.violation) : "") + ',' +
           text(best_of(table, row).cost) + ',' + text(row.gap) + ',' + (row.solved ? "1," : "0,") +
           text(1e3 * row.seconds_to_target) + ',' + text(row.evaluations_to_target) + ',' +
           (there ? text(1e3 * row.seconds) : "") + ',' +
           (row.deadline > 0.0 && there ? text(1e3 * row.overrun) : "") + ',' +
           std::to_string(row.counters.cost_evaluations) + ',' +
           std::to_string(row.counters.gradient_evaluations) + ',' +
           std::to_string(row.counters.iterations) + ',' + stop_of(row) + ',' +
           std::string(to_string(row.quality)) + ',' + csv::field(row.detail) + '\n';
  }
  return csv;
}

Json bench_json(const BenchTable& table, const std::vector<GroupSummary>& groups, bool traces,
                const Json& made_by) {
  Json sets = Json::array();
  for (std::size_t s = 0; s < table.sets.size(); ++s) {
    const ProblemSet& set = table.sets[s];
    Json problems = Json::array();
    for (std::size_t p = 0; p < set.problems.size(); ++p) {
      const BenchProblem& problem = set.problems[p];
      problems.push_back({{"name", problem.name},
                          {"variables", problem.problem->num_variables()},
                          {"constraints", problem.problem->num_constraints()},
                          {"best_known", table.best[s][p].cost},
                          {"best_known_by", table.best[s][p].found_by}});
    }
    sets.push_back({{"name", set.name},
                    {"best_known_source", set.best_known_source},
                    {"absolute_tolerance", set.absolute_tolerance},
                    {"problems", problems}});
  }
  Json rows = Json::array();
  for (const BenchRow& row : table.rows) rows.push_back(row_json(table, row, traces));
  Json summary = Json::array();
  for (const GroupSummary& group : groups) {
    Json solvers = Json::array();
    for (const SolverSummary& s : group.solvers) solvers.push_back(summary_json(s));
    summary.push_back({{"set", group.set},
                       {"deadline_s", group.deadline},
                       {"problems", group.problems},
                       {"solvers", solvers}});
  }
  return {{"program", std::string("prospect ") + kVersion},
          {"build", made_by},
          {"cancelled", table.cancelled},
          {"relative_tolerance", table.options.relative_tolerance},
          {"feasibility_tolerance", kFeasible},
          {"repeats", table.options.repeats},
          {"max_evaluations", table.options.max_evaluations},
          {"seed", table.options.seed},
          {"deadlines_s", table.options.deadlines},
          {"solvers", table.solvers},
          {"sets", sets},
          {"summary", summary},
          {"rows", rows}};
}

std::string bench_text(const BenchTable& table, const GroupSummary& group) {
  char line[256];
  std::string out = group.set + ", " + std::to_string(group.problems) + " problems, ";
  out += group.deadline > 0.0 ? "deadline " + exact_text(1e3 * group.deadline) + " ms"
                              : std::string("no deadline");
  out += ", at most " + std::to_string(table.options.max_evaluations) + " evaluations\n";
  int width = 10;
  for (const SolverSummary& s : group.solvers) {
    width = std::max(width, static_cast<int>(s.solver.size()));
  }
  std::snprintf(line, sizeof line, "%-*s %7s %9s %9s %9s %8s %9s %9s %8s %8s %10s\n", width,
                "solver", "solved", "to target", "p90 ms", "p99 ms", "evals", "solve ms", "p99 ms",
                "evals", "grads", "median gap");
  out += line;
  if (group.deadline > 0.0) out.insert(out.size() - 1, "  past deadline: p50, p99, max ms");
  for (const SolverSummary& s : group.solvers) {
    std::snprintf(
        line, sizeof line, "%-*s %3d/%-3d %9s %9s %9s %8s %9s %9s %8s %8s %10s", width,
        s.solver.c_str(), s.solved, s.problems, cell(s.ms_to_target_median, "%.3g").c_str(),
        cell(s.ms_to_target_p90, "%.3g").c_str(), cell(s.ms_to_target_p99, "%.3g").c_str(),
        cell(s.evaluations_to_target_median, "%.0f").c_str(), cell(s.ms_median, "%.3g").c_str(),
        cell(s.ms_p99, "%.3g").c_str(), cell(s.evaluations_median, "%.0f").c_str(),
        cell(s.gradients_median, "%.0f").c_str(), cell(s.gap_median, "%.2g").c_str());
    out += line;
    if (group.deadline > 0.0 && std::isfinite(s.ms_median)) {
      out += "  " + cell(s.overrun_ms_p50, "%.2g") + ", " + cell(s.overrun_ms_p99, "%.2g") + ", " +
             cell(s.overrun_ms_max, "%.2g");
    }
    if (s.refused > 0) out += "  refused " + std::to_string(s.refused);
    if (s.errors > 0) out += "  errors " + std::to_string(s.errors);
    out += '\n';
  }
  return out;
}

void open_bench_folder(const std::string& path) {
  std::error_code error;
  const char* const expected = "; expected a new or empty folder, or one of an earlier bench";
  fs::create_directories(path, error);
  if (error)
    throw InputError("--out " + path + ": cannot be made (" + error.message() + ")" + expected);
  if (!fs::is_directory(path)) throw InputError("--out " + path + ": is a file" + expected);
  if (!fs::is_empty(path, error) && !fs::is_regular_file(fs::path(path) / "bench.json")) {
    throw InputError("--out " + path + ": holds other files" + expected);
  }
}

void write_bench_folder(const std::string& path, const BenchTable& table,
                        const std::vector<GroupSummary>& groups, const Json& made_by) {
  const Json json = bench_json(table, groups, true, made_by);
  const std::pair<const char*, std::string> files[] = {
      {"bench.csv", bench_csv(table)},
      {"bench.html", bench_page(bench_json(table, groups, false, made_by))},
      {"bench.json", json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n'}};
  for (const auto& [name, content] : files) {
    const std::string file = (fs::path(path) / name).string();
    const std::string wrong = write_whole_file(file, content);
    if (!wrong.empty()) throw std::runtime_error(file + ": cannot be written (" + wrong + ")");
  }
}

}  // namespace prospect
