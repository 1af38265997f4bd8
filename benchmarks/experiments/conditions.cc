#include "benchmarks/experiments/conditions.h"

#include "adapters/config/input_error.h"

namespace prospect {

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> table = {
      {"with", "", ""},
      {"without", "planner: {weights: {w_l: 0}}", "with"},
      {"no_prior", "planner: {visibility: {prior: false}}", "with"},
      {"information", "planner: {visibility: {criterion: information}}", "with"},
      {"chance", "planner: {weights: {w_c: 0.5}}", "with"},
      {"holonomic_with", "robot: {model: holonomic}", ""},
      {"holonomic_without", "{robot: {model: holonomic}, planner: {weights: {w_l: 0}}}",
       "holonomic_with"},
  };
  return table;
}

const Condition& condition(const std::string& name) {
  std::string known;
  for (const Condition& c : conditions()) {
    if (c.name == name) return c;
    known += (known.empty() ? "" : ", ") + c.name;
  }
  throw InputError("unknown condition '" + name + "'; expected one of: " + known);
}

}  // namespace prospect
