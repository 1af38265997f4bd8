// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/image.h"

namespace prospect {

/// Many images on few pages, as a renderer draws few textures faster than many. About each image
/// its outermost pixels are repeated, so that smaller versions of a page mix little of its
/// neighbours into it.
struct TextureAtlas {
  static constexpr int kSide = 4096;      ///< [px] of a page, unless one image is larger
  static constexpr int kLargest = 16384;  ///< [px] a side of an image
  static constexpr int kMargin = 4;       ///< [px] repeated on each side

  struct Place {
    std::size_t page = 0;
    int x = 0, y = 0;  ///< of the image's first pixel
  };
  std::vector<Image> pages;
  std::vector<Place> places;  ///< of each image

  /// Texture coordinates of image n (u right, v down, [0, 1]^2 over the image) on its page.
  Eigen::Vector2d on_page(std::size_t n, const Image& image, const Eigen::Vector2d& uv) const;
};

/// Highest first, in rows. Deterministic. Throws std::invalid_argument for an empty image or one
/// larger than kLargest with its margin.
TextureAtlas pack_textures(const std::vector<Image>& images);

}  // namespace prospect
