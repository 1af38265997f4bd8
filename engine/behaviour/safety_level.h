// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "engine/behaviour/facts.h"

namespace prospect {

/// Which distances the robot keeps, and from what.
enum class SafetyLevel {
  kNormal,
  kReduced,  ///< the path ahead is narrow
  kStuck,    ///< no path out keeps the distances: nothing is touched, no more
  kLost      ///< localization is lost: what drifted while out of view is not entered
};

inline constexpr std::array kSafetyLevels = {SafetyLevel::kNormal, SafetyLevel::kReduced,
                                             SafetyLevel::kStuck, SafetyLevel::kLost};

/// "normal", "reduced margin", "stuck", "lost".
std::string_view to_string(SafetyLevel safety_level);

/// A row of the table of safety levels: condition on facts · safety level. In order of precedence:
/// the first row that holds is taken.
struct SafetyLevelRow {
  struct Case {
    const Facts& facts;
    bool fixed_lost_margin;
  };
  std::string_view condition;
  bool (*holds)(const Case&);
  SafetyLevel safety_level;
};

/// Total: its last row holds always.
std::span<const SafetyLevelRow> safety_level_table();

/// Of the first row that holds. Pure. fixed_lost_margin: the caller keeps a distance of its own
/// choice while localization is lost (planner.lost_margin), stuck or not.
SafetyLevel safety_level_for(const Facts& facts, bool fixed_lost_margin);

/// What a safety level means for the certificate and for the problem.
struct SafetyLevelPolicy {
  SafetyLevel safety_level;
  double margin;  ///< share of planner.certificate_margin
  double
      reduced_margin_share;  ///< of the distance of a robot within its margin (Certifier::Options)
  bool drift;                ///< the certificate minds how far surfaces and space may have drifted
  bool drift_margin;         ///< ... surfaces by a margin, too
  bool drift_in_cost;        ///< so does the soft cost of obstacles
  bool hard_clearance;       ///< the problem has planner.d_safe as a constraint
};

const SafetyLevelPolicy& policy(SafetyLevel safety_level);

}  // namespace prospect
