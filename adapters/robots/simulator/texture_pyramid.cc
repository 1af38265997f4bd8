// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/texture_pyramid.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "adapters/robots/simulator/texture_kernel.h"

namespace prospect {

TexturePyramid::TexturePyramid(const Image& image) : width_(image.width), height_(image.height) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() !=
          static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw std::invalid_argument("texture: expected an image with as many pixels as width x height");
  }
  // Sizes first: the texels are allocated once.
  int width = image.width, height = image.height;
  std::size_t size = 0;
  while (true) {
    columns_.push_back(256.0f * static_cast<float>(width));
    rows_.push_back(256.0f * static_cast<float>(height));
    stride_.push_back(width + 2);
    offset_.push_back(static_cast<std::int32_t>(size));
    size += (static_cast<std::size_t>(width) + 2) * (static_cast<std::size_t>(height) + 2);
    if (size > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
      throw std::invalid_argument("texture: more than 2^31 texels");
    }
    if (width == 1 && height == 1) break;
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  texels_.resize(size);
  cv::Mat current(image.height, image.width, CV_8UC1,
                  const_cast<std::uint8_t*>(image.pixels.data()));
  for (std::size_t level = 0; level < columns_.size(); ++level) {
    if (level > 0) {
      cv::Mat smaller;
      cv::resize(current, smaller, cv::Size((current.cols + 1) / 2, (current.rows + 1) / 2), 0, 0,
                 cv::INTER_AREA);
      current = smaller;
    }
    std::uint8_t* to = texels_.data() + offset_[level];
    for (int y = -1; y <= current.rows; ++y) {
      const std::uint8_t* from = current.ptr<std::uint8_t>((y + current.rows) % current.rows);
      *to++ = from[current.cols - 1];
      to = std::copy_n(from, current.cols, to);
      *to++ = from[0];
    }
  }
}

float TexturePyramid::bilinear(int level, float u, float v) const {
  return mean_along(static_cast<float>(level), u, v, 0.0f, 0.0f, 1);
}

float TexturePyramid::mean_along(float level, float u, float v, float du, float dv,
                                 int taps) const {
  return prospect::mean_along(texels(), level, u, v, du, dv, taps);
}

}  // namespace prospect
