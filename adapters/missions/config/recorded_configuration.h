// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/config/configuration.h"

namespace prospect {

/// What keys meant before they were there. A recorded configuration states all keys that its
/// version had: one that it lacks was added later, and its default may not be what was before it.
std::vector<YamlSetting> settings_before_their_keys();

/// The configuration of a mission that was recorded, as YAML for the same use: without the keys
/// that nothing reads there. A version writes all keys with its defaults; those of another version
/// may be others, and would be refused as told.
std::string recorded_yaml(const Configuration& configuration, ConfigurationUse use);

}  // namespace prospect
