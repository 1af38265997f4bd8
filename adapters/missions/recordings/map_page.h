// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "adapters/missions/recordings/map_run.h"

namespace prospect {

/// One self-contained HTML page of a run of `prospect map` that works offline: the occupied voxels
/// in 3-D (voxel_faces.h), to turn, zoom and cut by height; exploration and obstacle map with the
/// path; the ground over time; what was left out of the map, and why. A browser without WebGL shows
/// all but the first, and says so. `summary` is what the program prints as JSON. Without times of
/// the processor in it, the same run gives the same bytes.
std::string map_page(const MapRun& run, const nlohmann::ordered_json& summary);

/// Likewise of a run with loops, and of the same recording as its poses have it, `drawn`: the page
/// shows either, whole, as the reader chooses, and opens with the first.
std::string map_page(const MapRun& run, const nlohmann::ordered_json& summary, const MapRun& drawn,
                     const nlohmann::ordered_json& drawn_summary);

}  // namespace prospect
