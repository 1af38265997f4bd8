// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/config/configuration.h"

namespace prospect {

/// The configuration of a mission that was recorded, as YAML for the same use: without the keys
/// that nothing reads there. A version writes all keys with its defaults; those of another version
/// may be others, and would be refused as told.
std::string recorded_yaml(const Configuration& configuration, ConfigurationUse use);

}  // namespace prospect
