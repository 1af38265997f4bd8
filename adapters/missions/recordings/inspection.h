// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "adapters/formats/datasets/depth_source.h"
#include "adapters/formats/datasets/stereo_source.h"

namespace prospect {

/// What is at a path: recordings of a stereo pair, of depth
/// images or of a lidar, with their layout, images, rates, gaps, pairs, calibration, ground truth,
/// what was assumed and what is missing. Of a stereo pair also the time offset of the cameras, by
/// the odometry over its first 5 s, at most 60 frames; of worlds, maps and run folders only what
/// they are.
enum class Found {
  kUsable,      ///< known, and nothing is missing
  kIncomplete,  ///< known, and something is missing
  kUnknown      ///< nothing known
};

/// As JSON: "path", "found" (usable, incomplete, unknown) and "recordings", a list with an object
/// each, for a bag "topics" and "mission" (null: no log of a mission), or "what" and "used_by" of
/// anything else; numbers that do not exist are null. Throws InputError if there is nothing at the
/// path.
nlohmann::ordered_json inspect_path(const std::string& path, const StereoDatasetOptions& stereo,
                                    const DepthDatasetOptions& depth, Found& found);

/// The same in lines for people.
std::string inspection_text(const nlohmann::ordered_json& inspection);

}  // namespace prospect
