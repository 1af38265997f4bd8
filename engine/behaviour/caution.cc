#include "engine/behaviour/caution.h"

namespace prospect {
namespace {

// A robot that is lost drifts fast against all that it does not see: kept off that as well, it
// would not get out of where it got lost. Nor would one get out of a place it is stuck in.
constexpr std::array<CautionPolicy, 4> kCautionTable = {{
    {Caution::kNormal, "else", 1.0, 1.0, true, true, true, true},
    {Caution::kReduced, "the way ahead is narrow", 0.5, 1.0, true, true, true, false},
    {Caution::kStuck, "stuck, the way ahead is not narrow", 0.5, 0.0, false, false, false, true},
    {Caution::kLost, "localization lost", 1.0, 1.0, true, false, false, true},
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

Caution caution_for(const Facts& facts, bool fixed_lost_margin) {
  const bool lost = facts.localization == Localization::kLost;
  const bool narrow = facts.frontiers && facts.frontiers->narrow;
  if (lost && fixed_lost_margin) return Caution::kLost;
  if (facts.stuck && !narrow) return Caution::kStuck;
  if (lost) return Caution::kLost;
  return narrow ? Caution::kReduced : Caution::kNormal;
}

const CautionPolicy& policy(Caution caution) {
  return kCautionTable[static_cast<std::size_t>(caution)];
}

}  // namespace prospect
