// SPDX-License-Identifier: Apache-2.0
// A back end of one's own, loaded by the program at run time:
//   prospect solve office@40 --plugin FILE.so --solver differential_evolution
// Differential evolution, DE/rand/1/bin, of Storn and Price, J. Global Optimization 11 (1997): a
// population of points; each is challenged by a + F (b - c) of three others, crossed over with
// itself, and replaced if the challenger is no worse.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>

#include "solvers/plugin.h"
#include "solvers/solver_frame.h"

namespace {

using prospect::Evaluator;
using prospect::OptionSet;

// SolverFrame checks the options, evaluates the start and lets no exception out. The evaluator
// stays within the bounds, asks the stop condition, counts, and remembers the best point of all.
class DifferentialEvolution final : public prospect::SolverFrame {
 public:
  std::string name() const override { return "differential_evolution"; }
  std::vector<prospect::OptionInfo> options() const override {
    std::vector<prospect::OptionInfo> options = prospect::common_options();
    options.push_back({"population", 50, "points, 4 to 1000"});
    options.push_back({"weight", 0.6, "F, of the difference of two points, above 0, up to 2 [-]"});
    options.push_back({"crossover", 0.9, "share of the variables that are challenged, 0 to 1 [-]"});
    return options;
  }
  std::string explain_unsupported(const prospect::Problem&) const override { return {}; }

 protected:
  prospect::Evaluate start_evaluation() const override { return prospect::Evaluate::kValue; }

  void check_options(OptionSet& o) const override {
    const int population = o.integer("population");
    o.require(population >= 4 && population <= 1000, "option 'population': expected 4 to 1000");
    const double weight = o.number("weight"), crossover = o.number("crossover");
    o.require(weight > 0.0 && weight <= 2.0, "option 'weight': expected above 0, up to 2");
    o.require(crossover >= 0.0 && crossover <= 1.0, "option 'crossover': expected 0 to 1");
  }

  prospect::Result run(Evaluator& evaluator, const OptionSet& options,
                       const prospect::WarmStart& warm_start,
                       const Eigen::VectorXd& start) const override {
    const int n = evaluator.num_variables(), size = options.integer("population");
    const Eigen::VectorXd& lower = evaluator.lower();
    const Eigen::VectorXd range = evaluator.upper() - lower;
    const double weight = options.number("weight"), crossover = options.number("crossover");
    const double tolerance = evaluator.options().feasibility_tolerance;
    std::mt19937_64 generator(evaluator.options().seed);
    const auto uniform = [&] { return std::generate_canonical<double, 53>(generator); };
    const auto any = [&](int count) {
      return std::min(static_cast<int>(uniform() * count), count - 1);
    };

    Eigen::MatrixXd points(n, size), challengers(n, size);  // a column a point
    for (double& x : points.reshaped()) x = uniform();
    points = lower.replicate(1, size) + range.asDiagonal() * points;
    points.col(0) = start;
    Eigen::ArrayXd cost, violation, new_cost, new_violation;
    bool converged = false, more = evaluator.evaluate_batch(points, cost, violation) == size;
    while (more && !converged) {
      for (int i = 0; i < size; ++i) {
        int a, b, c;  // different from each other and from i
        do a = any(size);
        while (a == i);
        do b = any(size);
        while (b == i || b == a);
        do c = any(size);
        while (c == i || c == a || c == b);
        const int always = any(n);
        for (int j = 0; j < n; ++j) {
          const bool crossed = uniform() < crossover || j == always;
          const double x = points(j, a) + weight * (points(j, b) - points(j, c));
          challengers(j, i) = crossed ? std::clamp(x, lower[j], lower[j] + range[j]) : points(j, i);
        }
      }
      more = evaluator.evaluate_batch(challengers, new_cost, new_violation) == size;
      for (int i = 0; i < size; ++i) {  // feasible before infeasible, then the better one
        const double now = std::max(violation[i], tolerance);
        const double then = std::max(new_violation[i], tolerance);
        if (then > now || (then == now && new_cost[i] > cost[i])) continue;
        points.col(i) = challengers.col(i);
        cost[i] = new_cost[i], violation[i] = new_violation[i];
      }
      evaluator.count_iteration();
      const double spread = cost.maxCoeff() - cost.minCoeff();
      converged = violation.maxCoeff() <= tolerance &&
                  spread <= evaluator.options().tolerance * std::max(1.0, std::abs(cost[0]));
    }
    prospect::WarmStart next;
    next.time = warm_start.time;
    return evaluator.finish(prospect::StopReason::kConverged, false, "the points have met", next);
  }
};

}  // namespace

const prospect::Plugin* prospect_plugin() {
  static constexpr prospect::PluginSolver solvers[] = {
      {"differential_evolution", "differential evolution: a population that steps by differences",
       []() -> prospect::Solver* { return new DifferentialEvolution; }}};
  static constexpr prospect::Plugin plugin = {prospect::kPluginInterface, prospect::kPluginAbi,
                                              solvers, std::size(solvers)};
  return &plugin;
}
