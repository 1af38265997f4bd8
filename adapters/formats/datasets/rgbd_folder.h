// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace prospect {

/// Whether a folder looks like a recording of one camera with depth images: TUM RGB-D, 7-Scenes or
/// depth/NNN.png.
bool is_rgbd_folder(const std::string& path);

}  // namespace prospect
