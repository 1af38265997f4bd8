// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "adapters/formats/files/csv.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/bench/bench_curves.h"
#include "adapters/missions/bench/bench_page.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/planner_arena_log.h"
#include "models/range_text.h"
#include "models/version.h"

namespace prospect {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string text(double value) { return std::isfinite(value) ? exact_text(value) : std::string(); }

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

Json targets_json(const TargetCurve& curve, const char* axis) {
  Json at = Json::array(), share = Json::array(), low = Json::array(), high = Json::array();
  for (const TargetCurve::Point& point : curve.points) {
    at.push_back(point.at);
    share.push_back(point.share.mean);
    low.push_back(point.share.low);
    high.push_back(point.share.high);
  }
  return {{axis, at}, {"share", share}, {"low", low}, {"high", high}};
}

Json interval_json(const MeanInterval& interval) {
  return {{"mean", interval.mean}, {"low", interval.low}, {"high", interval.high}};
}

Json summary_json(const SolverSummary& s) {
  return {{"solver", s.solver},
          {"problems", s.problems},
          {"solved", s.solved},
          {"feasible", s.feasible},
          {"optima", s.optima},
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
          {"solved_share", interval_json(s.solved_share)},
          {"geometric_ms", interval_json(s.geometric_ms)},
          {"geometric_evaluations", interval_json(s.geometric_evaluations)},
          {"rank_by_time", interval_json(s.rank_by_time)},
          {"rank_by_evaluations", interval_json(s.rank_by_evaluations)},
          {"targets_over_time", targets_json(s.targets_over_time, "seconds")},
          {"targets_over_evaluations", targets_json(s.targets_over_evaluations, "evaluations")},
          {"profile_by_time", profile_json(s.by_time)},
          {"profile_by_evaluations", profile_json(s.by_evaluations)},
          {"gap_over_time", curve_json(s.over_time, "seconds")},
          {"gap_over_evaluations", curve_json(s.over_evaluations, "evaluations")}};
}

Json row_json(const BenchTable& table, const BenchRow& row, bool traces) {
  const bool there = ended_somewhere(row);
  Json json = {{"set", table.set_of(row).name},
               {"problem", table.problem_of(row).name},
               {"solver", table.solver_of(row)},
               {"deadline_s", row.deadline},
               {"cost", there ? Json(row.cost) : Json(nullptr)},
               {"violation", there ? Json(row.violation) : Json(nullptr)},
               {"gap", row.gap},
               {"solved", row.solved},
               {"ms_to_target", 1e3 * row.seconds_to_target},
               {"evaluations_to_target", row.evaluations_to_target},
               {"wall_ms", 1e3 * row.wall_seconds},
               {"cpu_ms", 1e3 * row.processor_seconds},
               {"overrun_ms", 1e3 * row.overrun},
               {"cost_evaluations", row.counters.cost_evaluations},
               {"gradient_evaluations", row.counters.gradient_evaluations},
               {"iterations", row.counters.iterations},
               {"stop_reason", stop_of(row)},
               {"quality", to_string(row.quality)},
               {"claimed", to_string(row.claimed)},
               {"optimality", row.optimality},
               {"held", row.held},
               {"seed", row.seed},
               {"environment", row.environment},
               {"load", row.load},
               {"detail", row.detail}};
  if (traces) {
    json["x"] = std::vector<double>(row.x.begin(), row.x.end());
    json["trace"] = trace_json(row);
  }
  return json;
}

/// "12.3", "-" for what is not there.
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
      "ms_to_target,evaluations_to_target,wall_ms,cpu_ms,clock,overrun_ms,cost_evaluations,"
      "gradient_evaluations,iterations,stop_reason,quality,seed,optimality,load,detail\n";
  for (const BenchRow& row : table.rows) {
    const ProblemFacts& problem = table.problem_of(row);
    const bool there = ended_somewhere(row);
    csv += csv::field(table.set_of(row).name) + ',' + csv::field(problem.name) + ',' +
           std::to_string(problem.variables) + ',' + std::to_string(problem.constraints) + ',' +
           csv::field(table.solver_of(row)) + ',' +
           (row.deadline > 0.0 ? exact_text(row.deadline) : std::string()) + ',' +
           (there ? text(row.cost) : "") + ',' + (there ? text(row.violation) : "") + ',' +
           text(table.best_of(row).cost) + ',' + text(row.gap) + ',' + (row.solved ? "1," : "0,") +
           text(1e3 * row.seconds_to_target) + ',' + text(row.evaluations_to_target) + ',' +
           (there ? text(1e3 * row.wall_seconds) : "") + ',' +
           (there ? text(1e3 * row.processor_seconds) : "") + ',' + to_string(table.clock) + ',' +
           (row.deadline > 0.0 && there ? text(1e3 * row.overrun) : "") + ',' +
           std::to_string(row.counters.cost_evaluations) + ',' +
           std::to_string(row.counters.gradient_evaluations) + ',' +
           std::to_string(row.counters.iterations) + ',' + stop_of(row) + ',' +
           std::string(to_string(row.quality)) + ',' + std::to_string(row.seed) + ',' +
           (there ? text(row.optimality) : "") + ',' + text(row.load) + ',' +
           csv::field(row.detail) + '\n';
  }
  return csv;
}

Json bench_json(const BenchTable& table, const std::vector<GroupSummary>& groups, bool traces) {
  Json sets = Json::array();
  for (std::size_t s = 0; s < table.sets.size(); ++s) {
    const ProblemSetFacts& set = table.sets[s];
    Json problems = Json::array();
    for (std::size_t p = 0; p < set.problems.size(); ++p) {
      const ProblemFacts& problem = set.problems[p];
      problems.push_back({{"name", problem.name},
                          {"variables", problem.variables},
                          {"constraints", problem.constraints},
                          {"fingerprint", problem.fingerprint},
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
          {"environments", table.environments},
          {"cancelled", table.cancelled},
          {"relative_tolerance", table.relative_tolerance},
          {"feasibility_tolerance", kFeasible},
          {"repeats", table.repeats},
          {"max_evaluations", table.max_evaluations},
          {"seeds", table.seeds},
          {"clock", to_string(table.clock)},
          {"waited", waited(table)},
          {"busy", busy_sentence(table)},
          {"deadlines_s", table.deadlines},
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
  if (table.clock == SolveClock::kProcessor) out += ", times of the processor";
  out += ", at most " + std::to_string(table.max_evaluations) + " evaluations\n";
  if (const std::string busy = busy_sentence(table); !busy.empty()) out += busy + '\n';
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

OutputFolder open_bench_folder(const std::string& path, EarlierRows earlier) {
  OutputFolder folder = OutputFolder::own(path, {"bench"});
  if (folder.state() != OutputFolder::State::kNew && earlier == EarlierRows::kRefused) {
    fail("--out " + path,
         std::string("holds a bench") +
             (folder.state() == OutputFolder::State::kBegun ? " that was broken off" : "") +
             "; expected --resume, or another folder, or --overwrite");
  }
  return folder;
}

void begin_bench_folder(OutputFolder& folder) { folder.begin({kBenchRows}, {kBenchRows}); }

std::string summary_csv(const std::vector<GroupSummary>& groups) {
  std::string csv =
      "set,deadline_s,solver,problems,solved,feasible,optima,refused,errors,ms_to_target_median,"
      "evaluations_to_target_median,ms_median,evaluations_median,gap_median";
  const std::pair<const char*, MeanInterval SolverSummary::*> intervals[] = {
      {"solved_share", &SolverSummary::solved_share},
      {"geometric_ms", &SolverSummary::geometric_ms},
      {"geometric_evaluations", &SolverSummary::geometric_evaluations},
      {"rank_by_time", &SolverSummary::rank_by_time},
      {"rank_by_evaluations", &SolverSummary::rank_by_evaluations}};
  for (const auto& [name, member] : intervals) {
    csv += std::string(",") + name + ',' + name + "_low," + name + "_high";
  }
  csv += '\n';
  for (const GroupSummary& group : groups) {
    for (const SolverSummary& s : group.solvers) {
      csv += csv::field(group.set) + ',' +
             (group.deadline > 0.0 ? exact_text(group.deadline) : std::string()) + ',' +
             csv::field(s.solver);
      for (const int count : {s.problems, s.solved, s.feasible, s.optima, s.refused, s.errors}) {
        csv += ',' + std::to_string(count);
      }
      for (const double value : {s.ms_to_target_median, s.evaluations_to_target_median, s.ms_median,
                                 s.evaluations_median, s.gap_median}) {
        csv += ',' + text(value);
      }
      for (const auto& [name, member] : intervals) {
        const MeanInterval& interval = s.*member;
        csv += ',' + text(interval.mean) + ',' + text(interval.low) + ',' + text(interval.high);
      }
      csv += '\n';
    }
  }
  return csv;
}

void write_bench_folder(OutputFolder& folder, const BenchTable& table,
                        const std::vector<GroupSummary>& groups) {
  const auto written = [&](const std::string& name, const std::string& wrong) {
    if (wrong.empty()) return;
    throw std::runtime_error((fs::path(folder.path()) / name).string() + ": cannot be written (" +
                             wrong + ")");
  };
  const auto write = [&](const std::string& name, const std::string& content) {
    written(name, folder.write(name, content));
  };
  const std::vector<CurveSheet> sheets = curve_sheets(groups);
  for (const CurveSheet& sheet : sheets) {
    write("figures/" + group_file_name(sheet.set, sheet.deadline) + '_' + sheet.name + ".svg",
          curve_svg(sheet));
  }
  for (std::size_t s = 0; s < table.sets.size(); ++s) {
    for (const double deadline : table.deadlines) {
      write("planner_arena/" + group_file_name(table.sets[s].name, deadline) + ".log",
            planner_arena_log(table, static_cast<int>(s), deadline));
    }
  }
  write("curves.csv", curves_csv(sheets));
  write("summary.csv", summary_csv(groups));
  write("bench.csv", bench_csv(table));
  write("bench.html", bench_page(bench_json(table, groups, false)));
  write("bench.json",
        bench_json(table, groups, true).dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
  if (!table.cancelled) written(OutputFolder::kMarker, folder.complete());
}

}  // namespace prospect
