// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/ground_picture.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "adapters/formats/images/image_codec.h"
#include "models/range_text.h"

namespace prospect {
namespace {

constexpr std::uint8_t kFree = 254, kOccupied = 0, kUnknown = 205;

/// The known cells' rectangle; one cell if nothing is known.
GridFrame known(const GroundMap& map) {
  const GridFrame& f = map.frame();
  int low[2] = {f.i0 + f.width, f.j0 + f.height}, high[2] = {f.i0, f.j0};
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    if (!map.explored(c)) continue;
    low[0] = std::min(low[0], c.i);
    low[1] = std::min(low[1], c.j);
    high[0] = std::max(high[0], c.i + 1);
    high[1] = std::max(high[1], c.j + 1);
  }
  if (low[0] >= high[0]) return {f.resolution, f.i0, f.j0, 1, 1};
  return {f.resolution, low[0], low[1], high[0] - low[0], high[1] - low[1]};
}

template <typename Shade>
GroundPicture draw(const GroundMap& map, const std::string& image_name, Shade shade) {
  const GridFrame frame = known(map);
  cv::Mat image(frame.height, frame.width, CV_8UC1);
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    image.at<std::uint8_t>(frame.height - 1 - (c.j - frame.j0), c.i - frame.i0) =
        shade(map.state(c));
  }
  const std::vector<std::uint8_t> bytes = encode_pixels(".png", image);
  GroundPicture picture;
  picture.png.assign(bytes.begin(), bytes.end());
  const double r = frame.resolution;
  picture.yaml = "image: " + image_name + "\nresolution: " + exact_text(r) + "\norigin: [" +
                 exact_text(r * frame.i0) + ", " + exact_text(r * frame.j0) +
                 ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return picture;
}

}  // namespace

GroundPicture obstacle_picture(const GroundMap& map, const std::string& image_name) {
  return draw(map, image_name, [](CellState state) {
    return state == CellState::kOccupied ? kOccupied : state == CellState::kFree ? kFree : kUnknown;
  });
}

GroundPicture exploration_picture(const GroundMap& map, const std::string& image_name) {
  return draw(map, image_name,
              [](CellState state) { return state == CellState::kUnknown ? kUnknown : kFree; });
}

}  // namespace prospect
