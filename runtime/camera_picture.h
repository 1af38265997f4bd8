// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "models/image.h"
#include "perception/odometry/odometry.h"

namespace prospect {

/// What the left camera showed, and the landmarks that were to be seen in it.
struct CameraPicture {
  std::shared_ptr<const Image> image;  ///< null: there is none
  std::vector<LandmarkSighting> sightings;
};

}  // namespace prospect
