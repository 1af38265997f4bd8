// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"
#include "engine/planner/replanner.h"

namespace prospect {

/// Makes a planner for a configuration; empty: the engine's Planner with the configured back end,
/// as run_exploration() makes it by itself.
using MakeReplanner = std::function<std::unique_ptr<Replanner>(const Configuration&)>;

/// Names of the planners that are compared: mpc (the engine's), nearest and cost-utility
/// (BaselinePlanner), nearest-mpc (nearest_frontier_parameters()).
std::vector<std::string> replanner_names();

/// Throws std::invalid_argument for a name that is none of these.
MakeReplanner replanner_maker(const std::string& name);

}  // namespace prospect
