// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "models/image.h"
#include "perception/odometry/odometry.h"

namespace prospect {

/// A left image with the landmarks that were to be seen in it, small enough for a page.
struct LandmarkPicture {
  struct Feature {
    float u, v;  ///< [px] of the small image
    int kind;    ///< 0 tracked, 1 made at this frame, 2 missed
  };
  int frame = 0;  ///< of the odometry, or planning step: what a page's slider counts
  int width = 0, height = 0;
  std::vector<std::uint8_t> jpeg;
  std::vector<Feature> features;
};

/// At most `max_width` px wide. The same input, the same bytes.
LandmarkPicture landmark_picture(int frame, const Image& image,
                                 const std::vector<LandmarkSighting>& sightings,
                                 int max_width = 640);

/// As page.js reads them.
nlohmann::ordered_json pictures_json(const std::vector<LandmarkPicture>& pictures);

}  // namespace prospect
