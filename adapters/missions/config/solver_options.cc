// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/solver_options.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/config/read_option.h"
#include "models/unicycle.h"

namespace prospect {
namespace {

/// One knot of a standing robot, which costs nothing.
Problem smallest_problem() {
  ProblemDefinition d;
  d.model = std::make_shared<const Unicycle>();
  d.x0 = Eigen::VectorXd::Zero(d.model->nx());
  d.u_previous = Eigen::VectorXd::Zero(d.model->nu());
  d.N = d.M = 1;
  return Problem(std::move(d));
}

/// Of an option that the back end takes, but does not list.
OptionValue guessed(const std::string& text) {
  int whole = 0;
  if (parse_number(text, whole)) return whole;
  double number = 0.0;
  if (parse_number(text, number)) return number;
  return text;
}

OptionValue read_solver_option(YamlMap& map, const std::string& name, const Solver& solver) {
  const std::vector<OptionInfo> known = solver.options();
  const auto info =
      std::find_if(known.begin(), known.end(), [&](const OptionInfo& o) { return o.name == name; });
  if (info == known.end()) return guessed(map.text(name, "", "of the back end"));
  return read_option(map, *info);
}

}  // namespace

std::string solver_options_problem(const Solver& solver, const Options& options) {
  if (options.empty()) return "";
  const Problem problem = smallest_problem();
  if (!solver.explain_unsupported(problem).empty()) return "";
  Options few = options;  // evaluations: some back ends use up what they are given
  few.try_emplace("max_evaluations", 20);
  const Result result = solver.solve(problem, {}, few, {});
  return result.stop == StopReason::kError ? result.detail : "";
}

Options read_solver_options(YamlMap map, const Solver& solver) {
  Options options;
  for (const std::string& name : map.keys()) {
    const std::size_t problems = map.problem_count();
    const OptionValue value = read_solver_option(map, name, solver);
    if (map.problem_count() != problems) continue;
    if (const std::string wrong = solver_options_problem(solver, {{name, value}}); !wrong.empty()) {
      map.problem(name, wrong);
      continue;
    }
    options[name] = value;
  }
  if (const std::string wrong = solver_options_problem(solver, options); !wrong.empty()) {
    map.problem("", wrong);
  }
  return options;
}

}  // namespace prospect
