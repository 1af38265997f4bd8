#pragma once

#include <array>
#include <span>
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

/// A row of the table of cautions: condition on facts · caution. In order of precedence: the first
/// row that holds is taken.
struct CautionRow {
  struct Case {
    const Facts& facts;
    bool fixed_lost_margin;
  };
  std::string_view condition;
  bool (*holds)(const Case&);
  Caution caution;
};

/// Total: its last row holds always.
std::span<const CautionRow> caution_table();

/// Of the first row that holds. Pure. fixed_lost_margin: the caller keeps a distance of its own
/// choice while localization is lost (planner.lost_margin), stuck or not.
Caution caution_for(const Facts& facts, bool fixed_lost_margin);

/// What a caution means for the certificate and for the problem.
struct CautionPolicy {
  Caution caution;
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
