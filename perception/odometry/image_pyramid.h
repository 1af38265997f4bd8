// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/image.h"

namespace prospect {

/// One level of a pyramid, grey values as float (they are sampled between pixels all the time).
struct PyramidLevel {
  int width = 0;
  int height = 0;
  Eigen::ArrayXf pixels;  // not a std::vector, which would write zeros first

  const float* row(int v) const { return pixels.data() + static_cast<std::size_t>(v) * width; }
};

/// Gaussian pyramid: level 0 is the image, level l + 1 is level l smoothed by the 5-tap binomial
/// kernel and halved, sizes rounded up. Pixel (u, v) of the image is (u, v) / 2^l of level l.
/// Levels that would be lower or narrower than `smallest` pixels are left out (level 0 never is).
/// An immutable value once made; may be read by any number of threads.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// Throws std::invalid_argument for an empty image or levels < 1.
  ImagePyramid(const ImageView& image, int levels, int smallest = 20);

  int levels() const { return static_cast<int>(levels_.size()); }
  const PyramidLevel& level(int l) const { return levels_[l]; }

 private:
  std::vector<PyramidLevel> levels_;
};

}  // namespace prospect
