// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/safety_level.h"

namespace prospect {
namespace {

using Case = SafetyLevelRow::Case;

bool is_lost(const Case& c) { return c.facts.localization == Localization::kLost; }
bool is_narrow(const Case& c) { return c.facts.frontiers && c.facts.frontiers->narrow; }

// A robot that is stuck in a narrow passage had better give it up than creep on. The map of one
// that is lost does not follow where the drift takes it, so it tries no narrow passage.
constexpr std::array kSafetyLevelTable = {
    SafetyLevelRow{"localization lost, planner.lost_margin more than 0",
                   [](const Case& c) { return is_lost(c) && c.fixed_lost_margin; },
                   SafetyLevel::kLost},
    SafetyLevelRow{"stuck, the path ahead is not narrow",
                   [](const Case& c) { return c.facts.stuck && !is_narrow(c); },
                   SafetyLevel::kStuck},
    SafetyLevelRow{"localization lost", is_lost, SafetyLevel::kLost},
    SafetyLevelRow{"the path ahead is narrow", is_narrow, SafetyLevel::kReduced},
    SafetyLevelRow{"else", [](const Case&) { return true; }, SafetyLevel::kNormal},
};

// A robot that is lost drifts fast against all that it does not see: kept off that as well, it
// would not get out of where it got lost. Nor would one get out of a place it is stuck in.
constexpr std::array<SafetyLevelPolicy, 4> kPolicies = {{
    {SafetyLevel::kNormal, 1.0, 1.0, true, true, true, true},
    {SafetyLevel::kReduced, 0.5, 1.0, true, true, true, false},
    {SafetyLevel::kStuck, 0.5, 0.0, false, false, false, true},
    {SafetyLevel::kLost, 1.0, 1.0, true, false, false, true},
}};

}  // namespace

std::string_view to_string(SafetyLevel safety_level) {
  switch (safety_level) {
    case SafetyLevel::kNormal:
      return "normal";
    case SafetyLevel::kReduced:
      return "reduced margin";
    case SafetyLevel::kStuck:
      return "stuck";
    case SafetyLevel::kLost:
      return "lost";
  }
  return "?";
}

std::span<const SafetyLevelRow> safety_level_table() { return kSafetyLevelTable; }

SafetyLevel safety_level_for(const Facts& facts, bool fixed_lost_margin) {
  const Case c{facts, fixed_lost_margin};
  for (const SafetyLevelRow& row : kSafetyLevelTable) {
    if (row.holds(c)) return row.safety_level;
  }
  return kSafetyLevelTable.back().safety_level;
}

const SafetyLevelPolicy& policy(SafetyLevel safety_level) {
  return kPolicies[static_cast<std::size_t>(safety_level)];
}

}  // namespace prospect
