#include "adapters/missions/run/planned_problem.h"

#include "engine/planner/planner.h"
#include "models/version.h"

namespace prospect {

std::optional<SavedProblem> planned_problem(const Planner& planner, const StepRecord& step,
                                            const std::string& world, std::uint64_t seed) {
  if (!planner.specification()) return std::nullopt;
  return SavedProblem{{std::string("prospect ") + kVersion, world, seed, step.step, step.time},
                      *planner.specification(),
                      planner.seeds(),
                      std::nullopt};
}

}  // namespace prospect
