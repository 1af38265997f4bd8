// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"

namespace prospect {

class Progress;

/// mission_world(), with progress while it is read, and lines on standard error of what its
/// source holds besides and of the scale that was assumed, if anything.
std::shared_ptr<const World> told_world(const std::string& name, const Configuration& configuration,
                                        ConfigurationUse use, Progress& progress);
/// "24 x 18 m": along x and y.
std::string size_text(const World& world);

}  // namespace prospect
