// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "adapters/views/report/run_figure.h"

namespace prospect {

struct Registries;

/// What the figures of a run need of its folder (docs/reference/report.md).
struct FigureSource {
  std::optional<ColoredPath> path;
  std::optional<GroundMap> map;  ///< of the octree, over the heights that the robot's body sweeps
};

/// Reads the path from steps.csv if `path_by` is given, and the map from map.bt; config.yaml and
/// trajectory_estimated.tum say which heights count. A run that was killed has no map.bt: the map
/// is absent then, which is an error only if `map_needed`. `solvers`: those that config.yaml may
/// name. Throws InputError, one line a problem, for whatever is missing, cut or no number.
FigureSource read_figure_source(const std::string& folder, std::optional<PathColor> path_by,
                                bool map_needed, const Registries& registries);

}  // namespace prospect
