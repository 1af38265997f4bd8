#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perception/image.h"

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
    const Level& l = levels_[static_cast<std::size_t>(level)];
    // Within the padded level: texel (0, 0) is at (1, 1), and its centre half a texel further.
    u -= floor(u);
    v -= floor(v);
    const float x = u * static_cast<float>(l.width) + 0.5f;
    const float y = v * static_cast<float>(l.height) + 0.5f;
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const float a = x - static_cast<float>(i), b = y - static_cast<float>(j);
    const std::uint8_t* t = texels_.data() + l.offset + static_cast<std::size_t>(j) * l.stride +
                            static_cast<std::size_t>(i);
    const float t00 = t[0], t10 = t[1], t01 = t[l.stride], t11 = t[l.stride + 1];
    const float upper = t00 + a * (t10 - t00);
    const float lower = t01 + a * (t11 - t01);
    return upper + b * (lower - upper);
  }
  /// Trilinear at `level` >= 0, a real number; levels beyond the last are the last.
  float trilinear(float level, float u, float v) const {
    const int low = static_cast<int>(level);
    if (low >= levels() - 1) return bilinear(levels() - 1, u, v);
    const float fraction = level - static_cast<float>(low);
    const float fine = bilinear(low, u, v);
    return fine + fraction * (bilinear(low + 1, u, v) - fine);
  }

 private:
  struct Level {
    int width, height;
    std::size_t stride;  // width + 2: a texel of the other side on each side
    std::size_t offset;
  };
  // std::floor of numbers that fit an int; without SSE 4.1 it is a call.
  static float floor(float x) {
    const auto whole = static_cast<float>(static_cast<int>(x));
    return whole > x ? whole - 1.0f : whole;
  }
  std::vector<Level> levels_;
  std::vector<std::uint8_t> texels_;
};

}  // namespace prospect
