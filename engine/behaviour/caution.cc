#include "engine/behaviour/caution.h"

namespace prospect {
namespace {

using Case = CautionRow::Case;

bool is_lost(const Case& c) { return c.facts.localization == Localization::kLost; }
bool is_narrow(const Case& c) { return c.facts.frontiers && c.facts.frontiers->narrow; }

// A robot that is stuck in a narrow passage had better give it up than creep on. The map of one
// that is lost does not follow where the drift takes it, so it tries no narrow passage.
constexpr std::array kCautionTable = {
    CautionRow{"localization lost, planner.lost_margin more than 0",
               [](const Case& c) { return is_lost(c) && c.fixed_lost_margin; }, Caution::kLost},
    CautionRow{"stuck, the way ahead is not narrow",
               [](const Case& c) { return c.facts.stuck && !is_narrow(c); }, Caution::kStuck},
    CautionRow{"localization lost", is_lost, Caution::kLost},
    CautionRow{"the way ahead is narrow", is_narrow, Caution::kReduced},
    CautionRow{"else", [](const Case&) { return true; }, Caution::kNormal},
};

// A robot that is lost drifts fast against all that it does not see: kept off that as well, it
// would not get out of where it got lost. Nor would one get out of a place it is stuck in.
constexpr std::array<CautionPolicy, 4> kPolicies = {{
    {Caution::kNormal, 1.0, 1.0, true, true, true, true},
    {Caution::kReduced, 0.5, 1.0, true, true, true, false},
    {Caution::kStuck, 0.5, 0.0, false, false, false, true},
    {Caution::kLost, 1.0, 1.0, true, false, false, true},
}};

}  // namespace

std::string_view to_string(Caution caution) {
  switch (caution) {
    case Caution::kNormal:
      return "normal";
    case Caution::kReduced:
      return "reduced margin";
    case Caution::kStuck:
      return "stuck";
    case Caution::kLost:
      return "lost";
  }
  return "?";
}

std::span<const CautionRow> caution_table() { return kCautionTable; }

Caution caution_for(const Facts& facts, bool fixed_lost_margin) {
  const Case c{facts, fixed_lost_margin};
  for (const CautionRow& row : kCautionTable) {
    if (row.holds(c)) return row.caution;
  }
  return kCautionTable.back().caution;
}

const CautionPolicy& policy(Caution caution) {
  return kPolicies[static_cast<std::size_t>(caution)];
}

}  // namespace prospect
