// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "engine/problem/solver.h"

namespace prospect {

enum class SamplingMethod {
  kSearch,        ///< systematic_search.h, then pattern_search.h
  kPathIntegral,  ///< path_integral.h
  kCrossEntropy,  ///< cross_entropy.h
  kBoth           ///< systematic search, path integral from its best, pattern search, path integral
};

/// Back ends that only evaluate candidates, in batches: no derivatives, any smoothness. Candidates
/// keep the rate limits of the model unless told otherwise. Nothing shows that a solution is
/// optimal, so the quality is kFeasible at best.
std::shared_ptr<const Solver> make_sampling_solver(std::string name, SamplingMethod method);

}  // namespace prospect
