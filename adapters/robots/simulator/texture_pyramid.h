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

  int width() const { return width_; }
  int height() const { return height_; }
  int levels() const { return static_cast<int>(columns_.size()); }

  /// The grey at (u, v), the image spanning [0, 1]^2: bilinear in `level`, 0 <= level < levels().
  float bilinear(int level, float u, float v) const;

  /// Mean of `taps` look-ups, evenly spread over the segment (du, dv) about (u, v). Each is
  /// trilinear at `level` >= 0, a real number; levels beyond the last are the last.
  float mean_along(float level, float u, float v, float du, float dv, int taps) const;

  /// What kernels read (texture_kernel.h). Of each level: its size in 256ths of a texel, the texels
  /// from row to row, and its first one's place. Around a level stands a texel of the other side.
  struct Texels {
    const float *columns, *rows;
    const std::int32_t *stride, *offset;
    const std::uint8_t* grey;
    std::int32_t levels;
  };
  Texels texels() const {
    return {columns_.data(), rows_.data(),   stride_.data(),
            offset_.data(),  texels_.data(), static_cast<std::int32_t>(levels())};
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<float> columns_, rows_;
  std::vector<std::int32_t> stride_, offset_;
  std::vector<std::uint8_t> texels_;
};

}  // namespace prospect
