#include "engine/safety/plan.h"

namespace prospect {

std::string_view to_string(PlanKind kind) {
  switch (kind) {
    case PlanKind::kOptimised:
      return "optimised";
    case PlanKind::kSeed:
      return "seed";
    case PlanKind::kStoppingTail:
      return "stopping tail";
  }
  return "?";
}

}  // namespace prospect
