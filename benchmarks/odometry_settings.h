// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "adapters/missions/config/configuration.h"

namespace prospect {

/// The odometry of `prospect odometry`, with settings of it such as pose.huber=2. Throws
/// InputError.
inline StereoOdometryOptions odometry_with(const std::vector<std::string>& settings) {
  std::vector<YamlSetting> all;
  for (const std::string& s : settings) all.emplace_back("perception.odometry." + s);
  return read_perception("", all, {}, ConfigurationUse::kOdometry).odometry;
}

}  // namespace prospect
