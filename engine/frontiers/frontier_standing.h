// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string_view>

namespace prospect {

/// How a frontier stood when FrontierPlanner asked which is next: what it is worth, what it takes,
/// and why it is next, later or not at all.
struct FrontierStanding {
  enum class Why {
    kInOrder,   ///< of the best sequence; the first of it is the target
    kLater,     ///< worth its path, but not in the sequence
    kLowYield,  ///< it promises less than FrontierPlannerOptions::least_rate for its time
    kLittle,    ///< it promises less than FrontierPlannerOptions::least_area
    kFarther,   ///< paths were searched only so far that no farther one can be next
    kNoPath     ///< to where it is seen from
  };
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  int frontier = -1;  ///< index in GlobalPlan::frontiers
  Why why = Why::kLater;
  double area = 0.0;  ///< E: that a look at it is expected to show [m^2]
  double time =
      kNone;  ///< until it has been looked at, alone and from here [s]; kNone: no path known
};

constexpr std::string_view name(FrontierStanding::Why why) {
  switch (why) {
    case FrontierStanding::Why::kInOrder:
      return "in order";
    case FrontierStanding::Why::kLater:
      return "later";
    case FrontierStanding::Why::kLowYield:
      return "low yield";
    case FrontierStanding::Why::kLittle:
      return "little";
    case FrontierStanding::Why::kFarther:
      return "farther";
    case FrontierStanding::Why::kNoPath:
      return "no path";
  }
  return "";
}

}  // namespace prospect
