// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "engine/maps/ground_map.h"

namespace prospect {

/// A ground map as a picture and the ROS map that goes with it: white free, black occupied, grey
/// (205) unknown, a pixel a cell, cut to what is known; x to the right, y up. world_from_ros_map()
/// and ROS's map_server read it back, cell for cell.
struct GroundPicture {
  std::string png;   ///< bytes of the image
  std::string yaml;  ///< names the image as given
};

/// The obstacle map: the three states as they are.
GroundPicture obstacle_picture(const GroundMap& map, const std::string& image_name);
/// The exploration map G(n): white explored, grey not.
GroundPicture exploration_picture(const GroundMap& map, const std::string& image_name);

}  // namespace prospect
