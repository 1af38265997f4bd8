// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/depth_image.h"

#include <cstring>

namespace prospect {
namespace {

template <typename T, typename Metres>
DepthImage convert(const T* from, int width, int height, std::ptrdiff_t stride,
                   const DepthRange& range, Metres metres) {
  if (from == nullptr || width <= 0 || height <= 0 || stride < width) return {};
  DepthImage image(width, height);
  float* to = image.depth.data();
  for (int v = 0; v < height; ++v, from += stride) {
    for (int u = 0; u < width; ++u, ++to) {
      const double z = metres(from[u]);
      if (range.holds(z)) *to = static_cast<float>(z);
    }
  }
  return image;
}

}  // namespace

bool DepthImage::same(const DepthImage& other) const {
  return width == other.width && height == other.height && depth.size() == other.depth.size() &&
         (depth.empty() ||
          std::memcmp(depth.data(), other.depth.data(), depth.size() * sizeof(float)) == 0);
}

DepthImage depth_image(const std::uint16_t* raw, int width, int height, std::ptrdiff_t stride,
                       double unit, const DepthRange& range) {
  return convert(raw, width, height, stride, range, [unit](std::uint16_t d) {
    const bool none = d == 0 || d == 65535;
    return none ? std::numeric_limits<double>::quiet_NaN() : unit * d;
  });
}

DepthImage depth_image(const float* metres, int width, int height, std::ptrdiff_t stride,
                       const DepthRange& range) {
  return convert(metres, width, height, stride, range, [](float z) { return double{z}; });
}

}  // namespace prospect
