// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/run/planned_problem.h"

#include "models/version.h"

namespace prospect {

std::optional<SavedProblem> planned_problem(const MissionStep& step, const std::string& world,
                                            std::uint64_t seed) {
  if (!step.made || !step.made->specification) return std::nullopt;
  return SavedProblem{{std::string("prospect ") + kVersion, world, seed, step.index, step.time},
                      *step.made->specification,
                      step.made->seeds,
                      std::nullopt};
}

}  // namespace prospect
