// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/registries.h"

namespace prospect {

/// Which planning problems of which missions.
struct MissionSet {
  std::vector<std::string> worlds;  ///< as load_world() takes them
  std::uint64_t seed = 1;           ///< of every mission
  int first = 4, every = 11;        ///< planning steps first, first + every, ...
  int problems = 14;                ///< of each world; a mission that ends early has fewer
};

/// What happens while missions are driven; both may be empty.
struct CaptureWatch {
  std::function<void(const std::string&)> progress;  ///< in a few words, at every step
  std::function<bool()> cancelled;                   ///< asked at every step
};

/// 112 problems on eight maps: the three built-in worlds and five floor plans.
MissionSet default_missions();
/// Nine problems on three maps, made in seconds.
MissionSet quick_missions();

/// Drives the missions in the kinematic simulator, with this configuration, up to the last
/// problem of each, and hands every problem to `take` as it is met. Deterministic: the same
/// problems from the same build on the same machine. False if it was cancelled: then those are
/// missing that were not yet met. Throws InputError for an unknown world and passes on what `take`
/// throws.
bool capture_missions(const MissionSet& missions, const Configuration& configuration,
                      const Registries& registries,
                      const std::function<void(const SavedProblem&)>& take,
                      const CaptureWatch& watch = {});

/// "office_000024.h5": a name for a problem of capture_missions().
std::string problem_file_name(const ProblemOrigin& origin);

}  // namespace prospect
