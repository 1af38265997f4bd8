// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/mode_policy.h"

namespace prospect {
namespace {

using Path = ModePolicy::CostToGo;
using From = ModePolicy::Seeds;

constexpr std::array<ModePolicy, 10> kPolicyTable = {{
    {ModeKind::kExplore, 1.0, 1.0, false, Path::kTarget, From::kAll, true},
    {ModeKind::kApproach, 1.0, 1.0, false, Path::kTarget, From::kApproach, true},
    {ModeKind::kLookAround, 1.0, 1.0, false, Path::kTarget, From::kTurn, true},
    {ModeKind::kRetreat, 0.0, 2.0, true, Path::kRetreat, From::kAll, false},
    {ModeKind::kTurnOnTheSpot, 1.0, 1.0, false, Path::kTarget, From::kTurn, false},
    {ModeKind::kGoToGoal, 1.0, 1.0, false, Path::kTarget, From::kAll, true},
    {ModeKind::kReturn, 1.0, 1.0, false, Path::kTarget, From::kAll, true},
    {ModeKind::kArrive, 0.0, 1.0, false, Path::kTarget, From::kArrive, true},
    {ModeKind::kHold, 0.0, 1.0, false, Path::kTarget, From::kStop, false},
    {ModeKind::kDone, 1.0, 1.0, false, Path::kTarget, From::kAll, true},
}};

}  // namespace

const ModePolicy& policy(ModeKind mode) { return kPolicyTable[static_cast<std::size_t>(mode)]; }

std::string_view to_string(ModePolicy::CostToGo cost_to_go) {
  return cost_to_go == Path::kRetreat ? "retreat" : "target";
}

std::string_view to_string(ModePolicy::Seeds seeds) {
  switch (seeds) {
    case From::kAll:
      return "all, polished";
    case From::kApproach:
      return "approach";
    case From::kTurn:
      return "turn";
    case From::kArrive:
      return "arrive";
    case From::kStop:
      return "stop";
  }
  return "?";
}

}  // namespace prospect
