#include "adapters/bench/solver_choice.h"

#include <cmath>

#include "adapters/config/configuration.h"
#include "adapters/files/input_error.h"
#include "adapters/files/parse_number.h"
#include "models/nearest_name.h"

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
  return choices;
}

}  // namespace prospect
