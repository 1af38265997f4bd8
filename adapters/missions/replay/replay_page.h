// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/replay/replay.h"

namespace prospect {

/// Both plans of each step side by side: trajectories over the map, cost by term, time, features
/// predicted and tracked; one file that works offline. It says that the other plans are open loop.
/// recorded, other: what each is called; changed: what the other has otherwise, "planner.N: 12".
std::string replay_page(const Replay& replay, const std::string& title, const std::string& recorded,
                        const std::string& other, const std::string& changed);

}  // namespace prospect
