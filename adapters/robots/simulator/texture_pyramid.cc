// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/texture_pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace prospect {

TexturePyramid::TexturePyramid(const Image& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() !=
          static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw std::invalid_argument("texture: expected an image with as many pixels as width x height");
  }
  // Sizes first: the texels are allocated once.
  int width = image.width, height = image.height;
  std::size_t offset = 0;
  while (true) {
    const Level level{width,
                      height,
                      256.0f * static_cast<float>(width),
                      256.0f * static_cast<float>(height),
                      static_cast<std::size_t>(width) + 2,
                      offset};
    offset += level.stride * (static_cast<std::size_t>(height) + 2);
    levels_.push_back(level);
    if (width == 1 && height == 1) break;
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  texels_.resize(offset);
  cv::Mat current(image.height, image.width, CV_8UC1,
                  const_cast<std::uint8_t*>(image.pixels.data()));
  for (const Level& level : levels_) {
    if (level.width != current.cols || level.height != current.rows) {
      cv::Mat smaller;
      cv::resize(current, smaller, cv::Size(level.width, level.height), 0, 0, cv::INTER_AREA);
      current = smaller;
    }
    for (int y = -1; y <= level.height; ++y) {
      const std::uint8_t* from = current.ptr<std::uint8_t>((y + level.height) % level.height);
      std::uint8_t* to =
          texels_.data() + level.offset + static_cast<std::size_t>(y + 1) * level.stride;
      to[0] = from[level.width - 1];
      std::copy(from, from + level.width, to + 1);
      to[level.width + 1] = from[0];
    }
  }
}

}  // namespace prospect
