// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// A Gazebo world file (.world, .sdf; SDF 1.5 or newer) with a robot in it: all that the file says
/// stays, and `model`, a <model> of SDF, is the last thing in its <world>. `folder` is where the
/// text will be written to.
///
/// Throws InputError with file and line: no SDF, no <world>, an older version, a model of the same
/// name that is there, or a file named by the world that lies beside it, and so would not be found
/// from another folder. NotBuiltIn where its libraries were absent.
std::string gazebo_world_with_robot(const std::string& path, const std::string& model,
                                    const std::string& folder);

}  // namespace prospect
