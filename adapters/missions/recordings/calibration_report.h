// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "adapters/missions/recordings/odometry_calibration.h"

namespace prospect {

/// Lines for a terminal: counts and scores of each horizon with either survival, the reliability of
/// the shortest horizon, and the consistency of both covariances.
std::string calibration_text(const OdometryCalibrationResult& result);

/// The same and all bins; numbers that are not finite are null.
nlohmann::ordered_json calibration_json(const OdometryCalibrationResult& result);

nlohmann::ordered_json consistency_json(const ConsistencyResult& result);

}  // namespace prospect
