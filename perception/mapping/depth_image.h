// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "models/camera.h"

namespace prospect {

/// Depths along the optical axis that a sensor measures [m]; any other value says nothing.
struct DepthRange {
  double min = 0.3;
  double max = 8.0;

  /// False for NaN and infinities, too.
  bool holds(double z) const { return z >= min && z <= max; }
};

/// A depth image as a value, rows without gaps: depth along the optical axis [m]. Pixel (u, v):
/// column u to the right, row v down; the centre of the first pixel is (0, 0). A pixel without a
/// measurement is NaN. Who reads an image tests every depth with DepthRange::holds(), so that one
/// made elsewhere, with zeros, infinities or negative numbers, is as harmless.
struct DepthImage {
  static constexpr float kInvalid = std::numeric_limits<float>::quiet_NaN();

  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  std::vector<float> depth;

  DepthImage() = default;
  DepthImage(int w, int h, float z = kInvalid)
      : width(w), height(h), depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), z) {}

  float& at(int u, int v) { return depth[index(u, v)]; }
  float at(int u, int v) const { return depth[index(u, v)]; }
  /// Whether the sizes are positive and there is a depth for each pixel.
  bool whole() const {
    return width > 0 && height > 0 &&
           depth.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// The same bits, NaN included.
  bool same(const DepthImage& other) const;

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
};

/// Image of 16-bit depths in units of `unit` [m] (0.001: millimetres), rows `stride` pixels apart.
/// Invalid become 0 and 65535, which drivers write where they measured nothing, and what lies
/// outside `range`. Empty if a size is not positive, `stride` < `width`, or `raw` is null.
DepthImage depth_image(const std::uint16_t* raw, int width, int height, std::ptrdiff_t stride,
                       double unit, const DepthRange& range = {});
/// Image of depths in metres, rows `stride` pixels apart: invalid become non-finite numbers and
/// what lies outside `range`, 0 and negative ones among them. Empty as above.
DepthImage depth_image(const float* metres, int width, int height, std::ptrdiff_t stride,
                       const DepthRange& range = {});

/// The ray of pixel (u, v) in C with unit component along the optical axis: the point at depth z is
/// z times it.
inline Eigen::Vector3d pixel_ray(const PinholeCamera& camera, double u, double v) {
  return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0};
}

}  // namespace prospect
