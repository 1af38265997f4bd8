// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/image.h"

namespace prospect {

/// A grey texture that repeats, at all its sizes: level 0 is the image, each next one half as large
/// (rounded up; a pixel is the mean of the area it covers) down to 1 x 1.
/// Immutable: concurrent reads are safe.
class TexturePyramid {
 public:
  /// Throws std::invalid_argument for an empty image.
  explicit TexturePyramid(const Image& image);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  int levels() const { return static_cast<int>(levels_.size()); }
  std::size_t bytes() const { return texels_.size(); }

  /// The grey at (u, v), the image spanning [0, 1]^2: bilinear in `level`, 0 <= level < levels().
  float bilinear(int level, float u, float v) const {
    return bilinear(levels_[static_cast<std::size_t>(level)], u - floor(u), v - floor(v));
  }

  /// Mean of `taps` look-ups, evenly spread over the segment (du, dv) about (u, v). Each is
  /// trilinear at `level` >= 0, a real number; levels beyond the last are the last.
  float mean_along(float level, float u, float v, float du, float dv, int taps) const {
    const int last = levels() - 1;
    const int low = level < static_cast<float>(last) ? static_cast<int>(level) : last;
    const float fraction =
        level < static_cast<float>(last) ? level - static_cast<float>(low) : 0.0f;
    const Level& fine = levels_[static_cast<std::size_t>(low)];
    const Level& coarse = levels_[static_cast<std::size_t>(low < last ? low + 1 : last)];
    const float share = 1.0f / static_cast<float>(taps);
    float sum = 0.0f;
    for (int k = 0; k < taps; ++k) {
      const float offset = (static_cast<float>(k) + 0.5f) * share - 0.5f;
      float s = u + offset * du, t = v + offset * dv;
      s -= floor(s);
      t -= floor(t);
      const float a = bilinear(fine, s, t), b = bilinear(coarse, s, t);
      sum += a + fraction * (b - a);
    }
    return sum * share;
  }

 private:
  struct Level {
    int width, height;
    float columns, rows;  // the same, in 256ths of a texel
    std::size_t stride;   // width + 2: a texel of the other side on each side
    std::size_t offset;
  };
  static constexpr float kHalfAndRounding = 128.5f;
  // Of 0 <= u, v <= 1.
  float bilinear(const Level& l, float u, float v) const {
    // Within the padded level: texel (0, 0) is at (1, 1), and its centre half a texel further. In
    // 256ths of a texel: whole numbers are quicker here than floating point.
    const int x = static_cast<int>(u * l.columns + kHalfAndRounding);
    const int y = static_cast<int>(v * l.rows + kHalfAndRounding);
    const int a = x & 255, b = y & 255;
    const std::uint8_t* t = texels_.data() + l.offset +
                            static_cast<std::size_t>(y >> 8) * l.stride +
                            static_cast<std::size_t>(x >> 8);
    const int upper = t[0] * (256 - a) + t[1] * a;
    const int lower = t[l.stride] * (256 - a) + t[l.stride + 1] * a;
    return static_cast<float>(upper * (256 - b) + lower * b) * 0x1p-16f;
  }
  // std::floor of numbers that fit an int; without SSE 4.1 it is a call.
  static float floor(float x) {
    const auto whole = static_cast<float>(static_cast<int>(x));
    return whole > x ? whole - 1.0f : whole;
  }
  std::vector<Level> levels_;
  std::vector<std::uint8_t> texels_;
};

}  // namespace prospect
