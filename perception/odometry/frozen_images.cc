// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frozen_images.h"

#include <cstddef>
#include <cstring>

namespace prospect {
namespace {

Image copy(const ImageView& view) {
  Image image;
  image.width = view.width;
  image.height = view.height;
  image.pixels.reserve(static_cast<std::size_t>(view.width) * view.height);
  for (int v = 0; v < view.height; ++v) {
    image.pixels.insert(image.pixels.end(), view.row(v), view.row(v) + view.width);
  }
  return image;
}

bool same(const std::shared_ptr<const Image>& image, const ImageView& view) {
  if (!image || image->width != view.width || image->height != view.height) return false;
  for (int v = 0; v < view.height; ++v) {
    if (std::memcmp(&image->pixels[static_cast<std::size_t>(v) * view.width], view.row(v),
                    view.width) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string FrozenImages::find(const ImageView& left, const ImageView& right) const {
  const bool old_left = same(left_, left), old_right = same(right_, right);
  if (old_left && old_right) return "the images are frozen";
  if (old_left) return "the left image is frozen";
  if (old_right) return "the right image is frozen";
  return {};
}

void FrozenImages::keep(const ImageView& left, const ImageView& right) {
  left_ = std::make_shared<const Image>(copy(left));
  right_ = std::make_shared<const Image>(copy(right));
}

}  // namespace prospect
