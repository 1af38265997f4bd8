// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/solver_choice.h"

#include <cmath>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/parse_number.h"
#include "adapters/missions/config/configuration.h"
#include "models/nearest_name.h"
#include "problems/zoo.h"

namespace prospect {
namespace {

OptionValue option_value(const SolverChoice& choice, const std::string& name,
                         const std::string& text) {
  std::vector<std::string> names;
  for (const OptionInfo& info : choice.solver->options()) {
    names.push_back(info.name);
    if (info.name != name) continue;
    if (std::holds_alternative<std::string>(info.fallback)) return text;
    if (std::holds_alternative<int>(info.fallback)) {
      int number = 0;
      if (parse_number(text, number)) return number;
      throw InputError("--solver: option '" + name + "' of " + choice.solver->name() + " is '" +
                       text + "'; expected a whole number");
    }
    double number = 0.0;
    if (parse_number(text, number) && std::isfinite(number)) return number;
    throw InputError("--solver: option '" + name + "' of " + choice.solver->name() + " is '" +
                     text + "'; expected a number");
  }
  throw InputError("--solver: " + choice.solver->name() + " has no option '" + name + "'" +
                   did_you_mean(name, names) + expected_one_of(names));
}

/// Why the back end refuses the options given; "" if it takes them, or cannot solve anyway. Ranges
/// are known to its solve() alone.
std::string refusal_of(const SolverChoice& choice) {
  if (choice.options.empty()) return "";
  constexpr double kEnough = 0.2;  // [s]
  const FunctionProblem quadratic = zoo::bounded_quadratic();
  const Problem problem = quadratic.problem();
  WarmStart start;
  start.x = quadratic.start;
  const auto solve = [&](const Options& options) {
    return choice.solver->solve(problem, start, options, deadline(kEnough));
  };
  if (solve({}).stop == StopReason::kError) return "";
  const Result result = solve(choice.options);
  return result.stop == StopReason::kError ? result.detail : "";
}

}  // namespace

std::vector<SolverChoice> choose_solvers(const std::vector<std::string>& words,
                                         const SolverRegistry& registry) {
  std::vector<SolverChoice> choices;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) {
      const std::string wrong = solver_problem(word, registry);
      if (!wrong.empty()) throw InputError("--solver: " + wrong);
      choices.push_back({word, registry.make(word), {}});
      continue;
    }
    if (choices.empty()) {
      throw InputError("--solver: option '" + word +
                       "' stands first; expected a back end before it");
    }
    SolverChoice& choice = choices.back();
    const std::string name = word.substr(0, equals);
    choice.options[name] = option_value(choice, name, word.substr(equals + 1));
    choice.label += "," + word;
  }
  for (std::size_t i = 0; i < choices.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (choices[i].label == choices[j].label) {
        throw InputError("--solver: '" + choices[i].label + "' is named twice; expected each once");
      }
    }
  }
  for (const SolverChoice& choice : choices) {
    if (const std::string why = refusal_of(choice); !why.empty()) {
      throw InputError("--solver: " + why);
    }
  }
  return choices;
}

}  // namespace prospect
