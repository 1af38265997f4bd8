// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "adapters/formats/problem_file/problem_file.h"
#include "runtime/mission.h"

namespace prospect {

/// The problem that the planner solved at this step of a mission, with its seeds, as a file holds
/// it. Nothing if it met none (a belief that nothing can be planned from), or does not tell.
std::optional<SavedProblem> planned_problem(const MissionStep& step, const std::string& world,
                                            std::uint64_t seed);

}  // namespace prospect
