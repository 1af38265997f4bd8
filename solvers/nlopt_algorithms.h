// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "engine/problem/solver.h"

namespace prospect {

/// One algorithm of NLopt that works under the Solver contract. Known here also where the library
/// is absent, so that the registry can say what is missing.
struct NloptAlgorithm {
  enum class Constraints {
    kNative,               ///< the algorithm takes c(x) >= 0 itself
    kAugmentedLagrangian,  ///< an outer loop, see augmented_lagrangian.h
    kPenalty               ///< f + penalty sum_i max(0, -c_i), static: for global methods
  };
  std::string_view name;  ///< as NLopt writes it, e.g. "LD_SLSQP"
  bool gradient;
  bool global;
  Constraints constraints;
  int least_variables;
  std::string_view description;
};

/// In alphabetical order of name.
const std::vector<NloptAlgorithm>& nlopt_algorithms();

/// The options of that algorithm, the common ones included.
std::vector<OptionInfo> nlopt_options(const NloptAlgorithm& algorithm);

/// The algorithm behind plain "nlopt".
inline constexpr std::string_view kDefaultNloptAlgorithm = "LD_SLSQP";

}  // namespace prospect
