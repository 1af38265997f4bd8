#include "benchmarks/experiments/conditions.h"

#include "adapters/files/input_error.h"

namespace prospect {

const std::vector<Condition>& conditions() {
  // A loss costs what it costs a robot that has little besides its cameras.
  const std::string poor =
      "simulator: {odometry: {reckoning_distance: 0.3, reckoning_angle: 0.2, "
      "reckoning_heading: 0.1}}";
  const std::string count = "{weights: {w_l: 0.5}, visibility: {criterion: count}}";
  const std::string without = "planner: {weights: {w_l: 0}}";
  const std::string holonomic = "robot: {model: holonomic}";
  const std::string slow = "robot: {motion: {v_max: 0.3}}";
  static const std::vector<Condition> table = {
      {"with", "", ""},
      {"without", without, "with"},
      {"count", "planner: " + count, "with"},
      {"chance", "planner: {weights: {w_c: 0.5}}", "with"},
      // What parts of the prediction, the price of ways and the horizon are worth.
      {"no_prior", "planner: {visibility: {prior: false}}", "with"},
      {"no_occlusion", "planner: {visibility: {occlusion: false}}", "with"},
      {"no_covariance", "planner: {visibility: {covariance: false}}", "with"},
      {"unweighted_ways", "planner: {frontiers: {lambda: 0}}", "with"},
      {"short_horizon", "planner: {N: 10, M: 5}", "with"},
      {"long_horizon", "planner: {N: 40, M: 20}", "with"},
      // Half the speed everywhere: more than slowing down where features are few could bring.
      {"slow", slow, "with"},
      // Back ends; `with` is solved by nlopt.
      {"ipopt", "planner: {solver: ipopt}", "with"},
      {"ceres", "planner: {solver: ceres}", "with"},
      {"sampling", "planner: {solver: sampling}", "with"},
      {"hybrid", "planner: {solver: hybrid}", "with"},
      // Frontier planners.
      {"nearest", "", "with", "nearest"},
      {"cost_utility", "", "with", "cost-utility"},
      {"nearest_mpc", "", "with", "nearest-mpc"},
      {"poor_wheels_with", poor, ""},
      {"poor_wheels_without", "{" + poor + ", " + without + "}", "poor_wheels_with"},
      {"poor_wheels_count", "{" + poor + ", planner: " + count + "}", "poor_wheels_with"},
      {"poor_wheels_slow", "{" + poor + ", " + slow + "}", "poor_wheels_with"},
      {"poor_wheels_nearest", poor, "poor_wheels_with", "nearest"},
      {"poor_wheels_cost_utility", poor, "poor_wheels_with", "cost-utility"},
      {"poor_wheels_nearest_mpc", poor, "poor_wheels_with", "nearest-mpc"},
      {"holonomic_with", holonomic, ""},
      {"holonomic_without", "{" + holonomic + ", " + without + "}", "holonomic_with"},
      {"poor_wheels_holonomic_with", "{" + poor + ", " + holonomic + "}", ""},
      {"poor_wheels_holonomic_without", "{" + poor + ", " + holonomic + ", " + without + "}",
       "poor_wheels_holonomic_with"},
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
