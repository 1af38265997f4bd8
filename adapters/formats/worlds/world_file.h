// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/formats/worlds/world.h"

namespace prospect {

/// A world file (YAML; the format stands in docs/reference/worlds.md): rooms, doors, furniture,
/// texture of each surface, start. Throws InputError with every problem of the file. Sets
/// `states_start` (if not null) to whether the file gives a start.
World world_from_file(const std::string& path, bool* states_start = nullptr);
World world_from_yaml(const std::string& text, const std::string& source,
                      bool* states_start = nullptr);

}  // namespace prospect
