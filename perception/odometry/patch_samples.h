#pragma once

#include <algorithm>

#include "perception/odometry/image_pyramid.h"

namespace prospect {

/// Half width r of the square patches that are aligned: 15 x 15 samples.
inline constexpr int kPatchRadius = 7;

/// Weight of the sample at the offset (x, y) from a patch's centre, before all are divided by their
/// sum: (1 - |x|^2 / (2 (r + 1)^2))^2. It falls to the border, where a patch is more likely to lie
/// on another surface.
inline float patch_weight(int x, int y) {
  const float s = 1.0f - (x * x + y * y) / (2.0f * (kPatchRadius + 1) * (kPatchRadius + 1));
  return s * s;
}

/// Bilinear sample at (x, y) [px]; the caller has checked that 0 <= x < width - 1 and likewise y,
/// to rounding: a corner of a patch, reached by other sums than the check's, may round to width - 1
/// itself.
inline float bilinear(const PyramidLevel& level, float x, float y) {
  const int u = std::min(static_cast<int>(x), level.width - 2);
  const int v = std::min(static_cast<int>(y), level.height - 2);
  const float a = x - u, b = y - v;
  const float* top = level.row(v) + u;
  const float* bottom = top + level.width;
  return (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
}

}  // namespace prospect
