// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/texture_atlas.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

namespace prospect {
namespace {

constexpr int kMargin = TextureAtlas::kMargin;

void draw(const Image& image, const TextureAtlas::Place& at, Image& page) {
  for (int y = -kMargin; y < image.height + kMargin; ++y) {
    const int v = std::clamp(y, 0, image.height - 1);
    for (int x = -kMargin; x < image.width + kMargin; ++x) {
      page.at(at.x + x, at.y + y) = image.at(std::clamp(x, 0, image.width - 1), v);
    }
  }
}

}  // namespace

Eigen::Vector2d TextureAtlas::on_page(std::size_t n, const Image& image,
                                      const Eigen::Vector2d& uv) const {
  const Place& place = places[n];
  const Image& page = pages[place.page];
  return {(place.x + uv.x() * image.width) / page.width,
          (place.y + uv.y() * image.height) / page.height};
}

TextureAtlas pack_textures(const std::vector<Image>& images) {
  std::vector<std::size_t> order(images.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return images[a].height > images[b].height;
  });
  TextureAtlas atlas;
  atlas.places.resize(images.size());
  struct Size {
    int width, height;
  };
  std::vector<Size> sizes;  // of pages; the last one is being filled
  int x = 0, row = 0, row_height = 0;
  for (const std::size_t n : order) {
    const int width = images[n].width + 2 * kMargin, height = images[n].height + 2 * kMargin;
    if (images[n].view().empty() || width > TextureAtlas::kLargest ||
        height > TextureAtlas::kLargest) {
      throw std::invalid_argument("texture atlas: an image of " + std::to_string(images[n].width) +
                                  " x " + std::to_string(images[n].height) +
                                  " pixels; expected at most " +
                                  std::to_string(TextureAtlas::kLargest - 2 * kMargin));
    }
    const bool begun = !sizes.empty();
    if (begun && x + width > sizes.back().width) {
      x = 0;
      row += row_height;
      row_height = 0;
    }
    if (!begun || width > sizes.back().width || row + height > sizes.back().height) {
      sizes.push_back(
          {std::max(width, TextureAtlas::kSide), std::max(height, TextureAtlas::kSide)});
      x = row = row_height = 0;
    }
    atlas.places[n] = {sizes.size() - 1, x + kMargin, row + kMargin};
    x += width;
    row_height = std::max(row_height, height);
  }
  // Of the last page, only what is used.
  if (!sizes.empty()) sizes.back().height = row + row_height;
  for (const Size& size : sizes) atlas.pages.emplace_back(size.width, size.height);
  for (const std::size_t n : order) {
    draw(images[n], atlas.places[n], atlas.pages[atlas.places[n].page]);
  }
  return atlas;
}

}  // namespace prospect
