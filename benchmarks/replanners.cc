#include "benchmarks/replanners.h"

#include <stdexcept>

#include "benchmarks/frontier_planner.h"
#include "benchmarks/frontier_rule.h"
#include "engine/planner.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

MakeReplanner frontier_planner(FrontierRule rule) {
  return [rule](const Configuration& c) {
    return std::make_unique<FrontierPlanner>(rule, c.robot, c.planner);
  };
}

}  // namespace

const std::vector<std::string>& replanner_names() {
  static const std::vector<std::string> names = {"mpc", "nearest", "cost-utility", "nearest-mpc"};
  return names;
}

MakeReplanner replanner_maker(const std::string& name) {
  if (name == "mpc") return {};
  if (name == "nearest") return frontier_planner(FrontierRule::kNearest);
  if (name == "cost-utility") return frontier_planner(FrontierRule::kCostUtility);
  if (name == "nearest-mpc") {
    return [](const Configuration& c) {
      return std::make_unique<Planner>(c.robot, nearest_frontier_parameters(c.planner),
                                       make_solver(c.solver));
    };
  }
  throw std::invalid_argument("planner '" + name +
                              "'; expected mpc, nearest, cost-utility or nearest-mpc");
}

}  // namespace prospect
