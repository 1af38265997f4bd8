// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
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

/// Bilinear samples at c + A x for the integer offsets x of the square |x_1|, |x_2| <= kHalf, row
/// by row; after them, up to whole vectors, samples at c. The caller has checked that every point
/// lies within [0, width - 1) x [0, height - 1), to rounding: a corner of the square, reached by
/// other sums than the check's, may round to width - 1 itself.
template <int kHalf>
auto sample_square(const PyramidLevel& level, const Eigen::Vector2f& c, const Eigen::Matrix2f& A) {
  constexpr int kSide = 2 * kHalf + 1;
  constexpr int kSamples = (kSide * kSide + 3) / 4 * 4;
  using Floats = Eigen::Array<float, kSamples, 1>;
  using Integers = Eigen::Array<int, kSamples, 1>;
  struct Offsets {
    Floats x = Floats::Zero(), y = Floats::Zero();
    Offsets() {
      for (int k = 0; k < kSide * kSide; ++k) {
        const int row = k / kSide, column = k % kSide;
        x[k] = static_cast<float>(column - kHalf);
        y[k] = static_cast<float>(row - kHalf);
      }
    }
  };
  static const Offsets offsets;
  const Floats x = c.x() + A(0, 0) * offsets.x + A(0, 1) * offsets.y;
  const Floats y = c.y() + A(1, 0) * offsets.x + A(1, 1) * offsets.y;
  const Integers u = x.template cast<int>().min(level.width - 2);
  const Integers v = y.template cast<int>().min(level.height - 2);
  const Floats a = x - u.template cast<float>(), b = y - v.template cast<float>();
  const Integers first = level.width * v + u;
  // Neighbours together: they are copied as one.
  float top[2 * kSamples], bottom[2 * kSamples];
  for (int k = 0; k < kSamples; ++k) {
    const float* from = level.row(0) + first[k];
    std::copy_n(from, 2, top + 2 * k);
    std::copy_n(from + level.width, 2, bottom + 2 * k);
  }
  Floats out;
  for (int k = 0; k < kSamples; ++k) {
    out[k] = (1.0f - b[k]) * ((1.0f - a[k]) * top[2 * k] + a[k] * top[2 * k + 1]) +
             b[k] * ((1.0f - a[k]) * bottom[2 * k] + a[k] * bottom[2 * k + 1]);
  }
  return out;
}

}  // namespace prospect
