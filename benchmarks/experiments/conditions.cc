#include "benchmarks/experiments/conditions.h"

#include "adapters/config/input_error.h"

namespace prospect {

const std::vector<Condition>& conditions() {
  // A loss costs what it costs a robot that has little besides its cameras.
  const std::string poor_wheels =
      "{reckoning_distance: 0.3, reckoning_angle: 0.2, reckoning_heading: 0.1}";
  const std::string count = "{weights: {w_l: 0.5}, visibility: {criterion: count}}";
  static const std::vector<Condition> table = {
      {"with", "", ""},
      {"without", "planner: {weights: {w_l: 0}}", "with"},
      {"count", "planner: " + count, "with"},
      {"no_prior", "planner: {visibility: {prior: false}}", "with"},
      {"chance", "planner: {weights: {w_c: 0.5}}", "with"},
      {"unweighted_ways", "planner: {frontiers: {lambda: 0}}", "with"},
      {"poor_wheels_with", "simulator: {odometry: " + poor_wheels + "}", ""},
      {"poor_wheels_without",
       "{simulator: {odometry: " + poor_wheels + "}, planner: {weights: {w_l: 0}}}",
       "poor_wheels_with"},
      {"poor_wheels_count", "{simulator: {odometry: " + poor_wheels + "}, planner: " + count + "}",
       "poor_wheels_with"},
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
