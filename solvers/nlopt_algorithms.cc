// SPDX-License-Identifier: Apache-2.0
#include "solvers/nlopt_algorithms.h"

#include "solvers/options.h"

namespace prospect {

const std::vector<NloptAlgorithm>& nlopt_algorithms() {
  using C = NloptAlgorithm::Constraints;
  static const std::vector<NloptAlgorithm> algorithms = {
      {"GN_CRS2_LM", false, true, C::kPenalty, 1,
       "controlled random search with local mutation, global"},
      {"GN_DIRECT_L", false, true, C::kPenalty, 1,
       "dividing rectangles, locally biased, global, deterministic"},
      {"GN_ISRES", false, true, C::kNative, 1,
       "evolution strategy with stochastic ranking of constraints, global"},
      {"LD_CCSAQ", true, false, C::kNative, 1,
       "conservative convex separable approximations, quadratic"},
      {"LD_LBFGS", true, false, C::kAugmentedLagrangian, 1,
       "limited-memory BFGS within bounds: least overhead a step"},
      {"LD_MMA", true, false, C::kNative, 1, "method of moving asymptotes"},
      {"LD_SLSQP", true, false, C::kNative, 1,
       "sequential quadratic programming: fewest evaluations, O(n^3) a step"},
      {"LD_TNEWTON_PRECOND_RESTART", true, false, C::kAugmentedLagrangian, 1,
       "truncated Newton, preconditioned, with restarts"},
      {"LD_VAR2", true, false, C::kAugmentedLagrangian, 1,
       "limited-memory variable metric, rank 2"},
      {"LN_BOBYQA", false, false, C::kAugmentedLagrangian, 2,
       "quadratic models in a trust region, no derivatives"},
      {"LN_COBYLA", false, false, C::kNative, 1, "linear models in a trust region, no derivatives"},
      {"LN_SBPLX", false, false, C::kAugmentedLagrangian, 1,
       "simplex on subspaces, no derivatives, stands kinks and noise"},
  };
  return algorithms;
}

std::vector<OptionInfo> nlopt_options(const NloptAlgorithm& algorithm) {
  std::vector<OptionInfo> options = common_options();
  if (algorithm.gradient &&
      algorithm.constraints == NloptAlgorithm::Constraints::kAugmentedLagrangian) {
    options.push_back({"vector_storage", 0, "pairs of steps remembered, 0: NLopt's choice"});
  }
  if (algorithm.name == "GN_CRS2_LM" || algorithm.name == "GN_ISRES") {
    options.push_back({"population", 0, "points in the population, 0: NLopt's choice"});
  }
  if (!algorithm.gradient && !algorithm.global) {
    options.push_back({"initial_step", 0.0,
                       "first step, as a fraction of the range of each variable, 0 to 1, "
                       "0: NLopt's choice [-]"});
  }
  if (algorithm.constraints == NloptAlgorithm::Constraints::kAugmentedLagrangian) {
    options.push_back({"initial_penalty", 10.0,
                       "rho of the first outer iteration, above 0 [cost / constraint^2]"});
    // Without derivatives the rounds that the margin adds cost more than they bring.
    options.push_back({"initial_margin", algorithm.gradient ? 0.01 : 0.0,
                       "by how much constraints are to be kept at first, 0 or more; falls to half "
                       "the feasibility tolerance [constraint]"});
  }
  if (algorithm.constraints == NloptAlgorithm::Constraints::kPenalty) {
    options.push_back({"penalty", 100.0, "weight of the summed violation [cost / constraint]"});
  }
  return options;
}

}  // namespace prospect
