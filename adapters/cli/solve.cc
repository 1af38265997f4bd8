#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "adapters/cli/commands.h"
#include "adapters/config/configuration.h"
#include "adapters/files/input_error.h"
#include "adapters/problem_file/problem_file.h"
#include "adapters/run/exploration_run.h"
#include "adapters/worlds/load_world.h"
#include "engine/planner/planner.h"

namespace prospect {
namespace {

struct NamedProblem {
  std::string name;
  std::shared_ptr<const Problem> problem;
  WarmStart warm_start;
};

/// The problem file `path`.
NamedProblem load(const std::string& path) {
  ReadProblem read = read_problem(path);
  NamedProblem named{path, std::move(read.problem), {}};
  if (read.saved.warm_start) {
    named.warm_start = std::move(*read.saved.warm_start);
  } else if (!read.saved.seeds.empty()) {
    named.warm_start.x = read.saved.seeds.front().z;
  }
  return named;
}

/// WORLD@STEP: runs the mission up to that planning step and takes the problem it meets there. Any
/// other text is the path of a problem file.
NamedProblem capture(const std::string& text, const Configuration& configuration,
                     const SolverRegistry& registry, std::uint64_t seed) {
  const std::size_t at = text.rfind('@');
  int step = -1;
  if (at != std::string::npos) {
    const char* first = text.data() + at + 1;
    const char* last = text.data() + text.size();
    const auto [end, error] = std::from_chars(first, last, step);
    if (error != std::errc() || end != last) step = -1;
  }
  if (step < 0) {
    const std::filesystem::path path(text);
    std::error_code ignored;
    if (path.extension() == ".h5" || std::filesystem::exists(path, ignored)) return load(text);
    throw InputError("problem '" + text +
                     "': no such file and no planning step; expected WORLD@STEP, e.g. office@40, "
                     "or a problem file");
  }
  const auto world = std::make_shared<const World>(
      load_world(text.substr(0, at), world_options_for(configuration)));
  tell_left_out(*world);
  int steps_done = 0;
  NamedProblem named{text, nullptr, {}};
  ExplorationRunOptions options;
  options.seed = seed;
  options.keep_steps = false;
  options.solvers = &registry;
  options.on_plan = [&](const StepRecord& record, const Planner& planner) {
    steps_done = record.step + 1;
    if (record.step != step) return;
    named.problem = planner.problem();
    // Every back end starts from the same point: the best seed.
    if (!planner.seeds().empty()) named.warm_start.x = planner.seeds().front().z;
  };
  options.cancelled = [&] { return steps_done > step; };
  run_exploration(world, configuration, options);
  if (!named.problem) {
    throw InputError("problem '" + text + "': the mission ends after " +
                     std::to_string(steps_done) + " steps; expected a step before that");
  }
  return named;
}

nlohmann::ordered_json to_json(const std::string& solver, const Result& r) {
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
          {"wall_ms", 1e3 * r.wall_seconds},
          {"stop_reason", to_string(r.stop)},
          {"quality", to_string(r.quality)},
          {"detail", r.detail}};
}

void print_table(const NamedProblem& named,
                 const std::vector<std::pair<std::string, Result>>& rows) {
  const Problem& p = *named.problem;
  std::printf("%s: %d variables, %d constraints\n", named.name.c_str(), p.num_variables(),
              p.num_constraints());
  std::printf("%-26s %12s %11s %7s %7s %9s  %-18s %s\n", "solver", "cost", "violation", "evals",
              "grads", "ms", "stopped by", "quality");
  for (const auto& [solver, r] : rows) {
    std::printf("%-26s %12.6g %11.3g %7d %7d %9.2f  %-18s %s\n", solver.c_str(), r.cost,
                r.violation, r.counters.cost_evaluations, r.counters.gradient_evaluations,
                1e3 * r.wall_seconds, std::string(to_string(r.stop)).c_str(),
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

}  // namespace

int solve(const SolveArguments& arguments, const SolverRegistry& registry) {
  Configuration configuration =
      read_configuration(arguments.configuration, registry, arguments.settings);
  std::vector<std::string> names = arguments.solvers;
  if (names.empty()) names = {"ipopt", "nlopt:LD_SLSQP", "nlopt:LD_LBFGS", "sampling"};
  std::vector<std::shared_ptr<const Solver>> solvers;
  for (const std::string& name : names) {
    const std::string wrong = solver_problem(name, registry);
    if (!wrong.empty()) throw InputError("--solver: " + wrong);
    solvers.push_back(registry.make(name));
  }

  // All of them before any is solved: a bad one is refused with nothing printed.
  std::vector<NamedProblem> problems;
  for (const std::string& text : arguments.problems) {
    problems.push_back(capture(text, configuration, registry, arguments.seed));
  }

  bool any_feasible = false, all_absent = true;
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const NamedProblem& named : problems) {
    Options options;
    options["max_evaluations"] = arguments.max_evaluations;
    options["seed"] = static_cast<int>(arguments.seed);
    std::vector<std::pair<std::string, Result>> rows;
    for (const auto& solver : solvers) {
      const StopCondition stop =
          arguments.deadline > 0.0 ? deadline(arguments.deadline) : StopCondition();
      rows.emplace_back(solver->name(),
                        solver->solve(*named.problem, named.warm_start, options, stop));
      const Result& r = rows.back().second;
      any_feasible |= r.quality == Quality::kFeasible || r.quality == Quality::kFeasibleOptimum;
      if (r.quality != Quality::kNone) all_absent = false;
      nlohmann::ordered_json row = to_json(solver->name(), r);
      if (problems.size() > 1) row["problem"] = named.name;
      json.push_back(std::move(row));
    }
    if (!arguments.json) print_table(named, rows);
    for (const auto& [solver, r] : rows) {
      if (r.stop == StopReason::kError) {
        std::cerr << "prospect: " << solver << ": " << r.detail << '\n';
      }
    }
  }
  if (arguments.json) {
    // A problem may be named after a file whose name is no UTF-8.
    std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  }
  if (all_absent) return kNotBuiltIn;
  return any_feasible ? kDone : kFailed;
}

}  // namespace prospect
