#pragma once

#include <array>
#include <string_view>

#include "engine/behaviour/facts.h"

namespace prospect {

/// Which distances the robot keeps, and from what.
enum class Caution {
  kNormal,
  kReduced,  ///< the way ahead is narrow
  kStuck,    ///< no way out keeps the distances: nothing is touched, no more
  kLost      ///< localization is lost: what drifted while out of view is not entered
};

inline constexpr std::array kCautions = {Caution::kNormal, Caution::kReduced, Caution::kStuck,
                                         Caution::kLost};

/// "normal", "reduced margin", "stuck", "lost".
std::string_view to_string(Caution caution);

/// Pure. fixed_lost_margin: the caller keeps a distance of its own choice while localization is
/// lost (planner.lost_margin), stuck or not.
///
/// In order of precedence:
///   lost, with such a distance            kLost
///   stuck, the way ahead is not narrow    kStuck: a robot that is stuck in a narrow passage had
///                                         better give it up than creep on
///   lost                                  kLost: its map does not follow where the drift takes it,
///                                         so it tries no narrow passage
///   the way ahead is narrow               kReduced
///   else                                  kNormal
Caution caution_for(const Facts& facts, bool fixed_lost_margin);

/// What a caution means for the certificate and for the problem.
struct CautionPolicy {
  Caution caution;
  std::string_view condition;
  double margin;  ///< share of planner.certificate_margin
  double
      reduced_margin_share;  ///< of the distance of a robot within its margin (Certifier::Options)
  bool drift;                ///< the certificate minds how far surfaces and space may have drifted
  bool drift_margin;         ///< ... surfaces by a margin, too
  bool drift_in_cost;        ///< so does the soft cost of obstacles
  bool hard_clearance;       ///< the problem has planner.d_safe as a constraint
};

const CautionPolicy& policy(Caution caution);

}  // namespace prospect
