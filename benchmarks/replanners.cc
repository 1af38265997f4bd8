// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/replanners.h"

#include <stdexcept>
#include <utility>

#include "benchmarks/baseline_planner.h"
#include "benchmarks/frontier_rule.h"
#include "engine/planner/planner.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

MakeReplanner baseline_planner(FrontierRule rule) {
  return [rule](const Configuration& c) {
    return std::make_unique<BaselinePlanner>(rule, c.robot, c.planner);
  };
}

std::unique_ptr<Replanner> nearest_by_mpc(const Configuration& c) {
  return std::make_unique<Planner>(c.robot, nearest_frontier_parameters(c.planner),
                                   make_solver(c.solver));
}

const std::vector<std::pair<std::string, MakeReplanner>>& table() {
  static const std::vector<std::pair<std::string, MakeReplanner>> all = {
      {"mpc", {}},
      {"nearest", baseline_planner(FrontierRule::kNearest)},
      {"cost-utility", baseline_planner(FrontierRule::kCostUtility)},
      {"nearest-mpc", nearest_by_mpc},
  };
  return all;
}

}  // namespace

std::vector<std::string> replanner_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : table()) names.push_back(name);
  return names;
}

MakeReplanner replanner_maker(const std::string& name) {
  std::string known;
  for (const auto& [other, make] : table()) {
    if (other == name) return make;
    known += (known.empty() ? "" : ", ") + other;
  }
  throw std::invalid_argument("planner '" + name + "'; expected one of: " + known);
}

}  // namespace prospect
