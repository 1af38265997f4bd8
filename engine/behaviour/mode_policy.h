// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/behaviour/mode.h"

namespace prospect {

/// What a mode means for the planning problem of a step.
struct ModePolicy {
  enum class CostToGo {
    kTarget,  ///< to the frontiers, or to the goal of the task
    kRetreat  ///< to where enough features were tracked, if anywhere
  };
  enum class Seeds {
    kAll,       ///< all of them, the best polished by the solver
    kApproach,  ///< along the path to the target, then facing it; the first certified one is taken
    kTurn,      ///< turning on the spot; the first certified one is taken
    kArrive,    ///< straight to the goal and turning to its heading; likewise
    kStop       ///< braking
  };
  ModeKind mode;
  double exploration_weight;  ///< factor on planner.weights.w_e
  double features_weight;     ///< factor on planner.weights.w_l
  /// Features are counted, twice as many required as end a retreat: what ends it is a number of
  /// points, and few that are well placed tell all the information that may be asked for.
  bool count_features;
  CostToGo cost_to_go;
  Seeds seeds;
  bool pursues;  ///< it tries to reach its target: time without progress counts
};

const ModePolicy& policy(ModeKind mode);

/// "target", "retreat"; "all, polished", "approach", "turn", "arrive", "stop".
std::string_view to_string(ModePolicy::CostToGo cost_to_go);
std::string_view to_string(ModePolicy::Seeds seeds);

}  // namespace prospect
