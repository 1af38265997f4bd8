// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace prospect {

/// Names of the worlds that come with the program: office, office_bare, corridor, loop.
std::vector<std::string> builtin_world_names();
/// One line on what the world is for; "" for an unknown name.
std::string builtin_world_summary(const std::string& name);
/// The world file (YAML) of a built-in world, to read, print or copy; "" for an unknown name.
std::string builtin_world_text(const std::string& name);

}  // namespace prospect
