// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/formats/programmes/nl_reader.h"
#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/bench/expression_file.h"
#include "adapters/missions/bench/solver_choice.h"
#include "adapters/missions/bench/stated_bounds.h"
#include "adapters/missions/bench/stated_problem.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/absent_solver.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/configuration_arguments.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/progress.h"
#include "adapters/program/cli/told_world.h"
#include "engine/planner/planner.h"

namespace prospect {
namespace {

struct SolveArguments {
  std::vector<std::string> problems;     ///< problem files, WORLD@STEP
  ConfigurationArguments configuration;  ///< of the missions of WORLD@STEP
  std::vector<std::string> solvers;  ///< names, each followed by its options; empty: one of a kind
  double deadline = 0.0;             ///< [s], 0: none
  SolveClock clock = SolveClock::kWall;
  int max_evaluations = 400;
  std::uint64_t seed = 1;
  bool json = false;
  bool quiet = false;
};

/// The problem file `path`.
BenchProblem load(const std::string& path, const TermRegistry& terms) {
  if (std::filesystem::path(path).extension() == ".nl") {
    StatedProgramme programme = read_nl(path);
    programme.name = path;
    return stated_problem(std::move(programme));
  }
  ReadProblem read = read_problem(path, terms);
  BenchProblem named;
  named.name = path;
  named.problem = std::move(read.problem);
  if (read.saved.warm_start) {
    named.start = std::move(*read.saved.warm_start);
  } else if (!read.saved.seeds.empty()) {
    named.start.x = read.saved.seeds.front().z;
  }
  return named;
}

/// The problems of a file of expressions.
bool holds_expressions(const std::string& path) {
  return std::filesystem::path(path).extension() == ".json";
}

/// The step of WORLD@STEP; -1 of any other text, which is the path of a problem file.
int step_of(const std::string& text) {
  const std::size_t at = text.rfind('@');
  int step = -1;
  if (at != std::string::npos) {
    const char* first = text.data() + at + 1;
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(first, last, step);
    if (error != std::errc() || end != last) step = -1;
  }
  if (step >= 0) return step;
  const std::filesystem::path path(text);
  std::error_code ignored;
  if (path.extension() == ".h5" || path.extension() == ".nl" ||
      std::filesystem::exists(path, ignored))
    return -1;
  throw InputError("problem '" + text +
                   "': no such file and no planning step; expected WORLD@STEP, e.g. office@40, "
                   "a problem file or a file of expressions (.json)");
}

/// What a mission is driven for.
struct Capture {
  std::string name;  ///< WORLD@STEP
  std::shared_ptr<const World> world;
  int step = 0;
};

/// Takes the problem of one planning step of a mission.
class StepCapture final : public RunObserver {
 public:
  StepCapture(const Capture& wanted, BenchProblem& named, Progress& progress)
      : wanted_(wanted), named_(named), progress_(progress) {}

  void on_record(const StepRecord& record, const MissionStep& step) override {
    steps_done = record.step + 1;
    progress_.show(wanted_.name + ": step " + std::to_string(record.step) + " of " +
                   std::to_string(wanted_.step) + ", " +
                   std::to_string(std::lround(100.0 * record.coverage)) + " % explored");
    if (record.step != wanted_.step) return;
    if (step.made) named_.problem = step.made->problem;
    if (!named_.problem) no_problem = record.certificate;
    // Every back end starts from the same point: the best seed.
    if (step.made && !step.made->seeds.empty()) named_.start.x = step.made->seeds.front().z;
  }

  int steps_done = 0;
  std::string no_problem;  // why the step has none

 private:
  const Capture& wanted_;
  BenchProblem& named_;
  Progress& progress_;
};

/// Runs the mission up to that planning step and takes the problem it meets there.
BenchProblem capture(const Capture& wanted, const Configuration& configuration,
                     const Registries& registries, std::uint64_t seed, Progress& progress) {
  BenchProblem named;
  named.name = wanted.name;
  StepCapture taken(wanted, named, progress);
  ExplorationRunOptions options;
  options.seed = seed;
  options.keep_steps = false;
  options.solvers = &registries.solvers;
  options.observers = [&](const Configuration&) { return std::vector<RunObserver*>{&taken}; };
  options.cancelled = [&] { return taken.steps_done > wanted.step; };
  run_exploration(wanted.world, configuration, options);
  progress.finish();
  if (!taken.no_problem.empty()) {
    throw InputError("problem '" + wanted.name + "': the step has none: " + taken.no_problem +
                     "; expected another step");
  }
  if (!named.problem) {
    throw InputError("problem '" + wanted.name + "': the mission ends after " +
                     std::to_string(taken.steps_done) + " steps; expected a step before that");
  }
  return named;
}

nlohmann::ordered_json to_json(const std::string& solver, const Result& r,
                               const std::string& clock) {
  nlohmann::ordered_json terms = nlohmann::ordered_json::object();
  for (const TermValue& t : r.explanation.terms) {
    terms[t.name] = {{"raw", t.raw}, {"weighted", t.weighted}, {"unit", t.unit}};
  }
  return {{"solver", solver},
          {"cost", r.cost},
          {"violation", r.violation},
          {"terms", terms},
          {"cost_evaluations", r.counters.cost_evaluations},
          {"gradient_evaluations", r.counters.gradient_evaluations},
          {"iterations", r.counters.iterations},
          {clock + "_ms", 1e3 * r.seconds},
          {"stop_reason", to_string(r.stop)},
          {"quality", to_string(r.quality)},
          {"detail", r.detail}};
}

void print_table(const BenchProblem& named, const std::vector<std::pair<std::string, Result>>& rows,
                 const std::string& clock) {
  const Problem& p = *named.problem;
  std::printf("%s: %d variables, %d constraints\n", named.name.c_str(), p.num_variables(),
              p.num_constraints());
  std::printf("%-26s %12s %11s %7s %7s %9s  %-18s %s\n", "solver", "cost", "violation", "evals",
              "grads", (clock == "wall" ? "ms" : clock + " ms").c_str(), "stopped by", "quality");
  for (const auto& [solver, r] : rows) {
    std::printf("%-26s %12.6g %11.3g %7d %7d %9.2f  %-18s %s\n", solver.c_str(), r.cost,
                r.violation, r.counters.cost_evaluations, r.counters.gradient_evaluations,
                1e3 * r.seconds, std::string(to_string(r.stop)).c_str(),
                std::string(to_string(r.quality)).c_str());
  }
  std::printf("\n%-26s", "weighted terms");
  for (const auto& [solver, r] : rows) std::printf(" %20s", solver.c_str());
  std::printf("\n");
  const Explanation reference = p.explain(rows.front().second.x);
  for (std::size_t i = 0; i < reference.terms.size(); ++i) {
    const TermValue& t = reference.terms[i];
    std::printf("%-26s", (t.name + (t.constraint ? " >= 0" : "")).c_str());
    for (const auto& [solver, r] : rows) {
      if (i < r.explanation.terms.size()) {
        const TermValue& v = r.explanation.terms[i];
        std::printf(" %20.6g", v.constraint ? v.raw : v.weighted);
      } else {
        std::printf(" %20s", "-");
      }
    }
    std::printf("\n");
  }
  std::printf("\n");
}

int solve(const SolveArguments& arguments, const Registries& registries, SignalGuard& signals) {
  const Configuration configuration =
      read_told(arguments.configuration, registries, ConfigurationUse::kExplore);
  std::vector<std::string> names = arguments.solvers;
  if (names.empty()) names = {"ipopt", "nlopt:LD_SLSQP", "nlopt:LD_LBFGS", "sampling"};
  const std::vector<SolverChoice> solvers = choose_solvers(names, registries.solvers);

  // All of them before any is solved: a bad one is refused with nothing printed.
  Progress progress(arguments.quiet);
  std::vector<BenchProblem> problems;
  std::vector<Capture> captures;  // by problem
  for (const std::string& text : arguments.problems) {
    const int step = step_of(text);
    if (step < 0 && holds_expressions(text)) {
      for (BenchProblem& problem : read_expression_file(text).problems) {
        problem.name = text + ": " + problem.name;
        problems.push_back(std::move(problem));
        captures.push_back({text, nullptr, step});
      }
      continue;
    }
    problems.push_back(step < 0 ? load(text, registries.terms) : BenchProblem{});
    captures.push_back({text, nullptr, step});
    if (step < 0) continue;
    captures.back().world = told_world(text.substr(0, text.rfind('@')), configuration,
                                       ConfigurationUse::kExplore, progress);
  }
  const bool driven =
      std::any_of(captures.begin(), captures.end(), [](const Capture& c) { return c.step >= 0; });
  if (!driven && !arguments.configuration.empty()) {
    throw InputError(
        "--config and --set: of no effect on problem files; expected a WORLD@STEP among them");
  }
  for (std::size_t k = 0; k < problems.size(); ++k) {
    if (captures[k].step < 0) continue;
    problems[k] = capture(captures[k], configuration, registries, arguments.seed, progress);
  }

  signals.note();  // not before: until here nothing is solved
  const std::function<bool()> cancelled = signals.came();
  bool any_feasible = false;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const BenchProblem& named : problems) {
    std::vector<std::pair<std::string, Result>> rows;
    for (const SolverChoice& choice : solvers) {
      Options options = choice.options;
      options.try_emplace("max_evaluations", arguments.max_evaluations);
      options.try_emplace("seed", static_cast<int>(arguments.seed));
      const StopCondition stop =
          deadline(arguments.deadline > 0.0 ? arguments.deadline : StopCondition::kNever,
                   arguments.clock) ||
          cancelled_by(cancelled);
      rows.emplace_back(choice.label,
                        solve_within_stated_bounds(named, *choice.solver, options, stop).result);
      if (cancelled()) {
        rows.pop_back();  // not what it would have found
        break;
      }
      const Result& r = rows.back().second;
      any_feasible |= r.quality == Quality::kFeasible || r.quality == Quality::kFeasibleOptimum;
      nlohmann::ordered_json row = to_json(choice.label, r, to_string(arguments.clock));
      if (problems.size() > 1) row["problem"] = named.name;
      json.push_back(std::move(row));
    }
    if (!arguments.json && !rows.empty()) print_table(named, rows, to_string(arguments.clock));
    for (const auto& [solver, r] : rows) {
      if (r.stop == StopReason::kError) {
        std::cerr << "prospect: " << solver << ": " << r.detail << '\n';
      }
    }
    if (cancelled()) break;
  }
  if (arguments.json) {
    // A problem may be named after a file whose name is no UTF-8.
    std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  }
  if (cancelled()) {
    std::cerr << "prospect: cancelled; the solves that were done are shown\n";
    return kCancelled;
  }
  if (std::all_of(solvers.begin(), solvers.end(), [&](const SolverChoice& choice) {
        return is_absent(choice.solver->name(), registries.solvers);
      })) {
    return kNotBuiltIn;
  }
  return any_feasible ? kDone : kFailed;
}

}  // namespace

Command solve_command(CLI::App& program) {
  const auto given = std::make_shared<SolveArguments>();
  SolveArguments& arguments = *given;
  CLI::App* command =
      program.add_subcommand("solve", "One planning problem, several back ends, side by side");
  command
      ->add_option(
          "problem", arguments.problems,
          "Problem file (explore --save-problems), .nl, file of problems as expressions (.json), "
          "or WORLD@STEP: the problem that a mission in WORLD meets at planning step STEP")
      ->type_name("PROBLEM")
      ->required();
  add_configuration(command, arguments.configuration, " of the mission of WORLD@STEP");
  command
      ->add_option("--solver", arguments.solvers,
                   "Back ends, separated by commas; NAME,OPTION=VALUE sets an option of one")
      ->type_name("SOLVER")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--deadline", arguments.deadline, "Limit of each solve [s]; 0: none")
      ->check(number_within(0.0, 3600.0));
  add_clock(command, arguments.clock);
  command->add_option("--max-evaluations", arguments.max_evaluations, "Of each solve")
      ->check(whole_number_within(1, 100000000))
      ->capture_default_str();
  command->add_option("--seed", arguments.seed, "Of the mission and the solvers")
      ->check(whole_number_within(0, std::numeric_limits<int>::max()))
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "Print JSON");
  command->add_flag("--quiet", arguments.quiet, "No progress line");
  return {command,
          [given](const Invocation& in) { return solve(*given, in.registries, in.signals); }};
}

}  // namespace prospect
