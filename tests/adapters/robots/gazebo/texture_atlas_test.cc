// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/texture_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace prospect::texture_atlas_test {
namespace {

TEST(TextureAtlas, EachImageIsWholeAndItsMarginRepeatsIt) {
  std::vector<Image> images;
  for (int n = 0; n < 40; ++n) {
    Image image(1 + 37 * n % 50, 1 + 53 * n % 40);
    for (std::size_t k = 0; k < image.pixels.size(); ++k) {
      image.pixels[k] = static_cast<std::uint8_t>(1 + (7 * k + static_cast<std::size_t>(n)) % 255);
    }
    images.push_back(image);
  }
  images.emplace_back(TextureAtlas::kSide, 3, 200);  // wider than a page with its margin
  const TextureAtlas atlas = pack_textures(images);
  EXPECT_EQ(atlas.pages.size(), 2u);
  for (std::size_t n = 0; n < images.size(); ++n) {
    const TextureAtlas::Place& place = atlas.places[n];
    const Image& image = images[n];
    const Image& page = atlas.pages[place.page];
    int wrong = 0;
    constexpr int kMargin = TextureAtlas::kMargin;
    for (int y = -kMargin; y < image.height + kMargin; ++y) {
      for (int x = -kMargin; x < image.width + kMargin; ++x) {
        const int u = std::min(std::max(x, 0), image.width - 1);
        const int v = std::min(std::max(y, 0), image.height - 1);
        wrong += page.at(place.x + x, place.y + y) != image.at(u, v);
      }
    }
    EXPECT_EQ(wrong, 0) << n;
    const Eigen::Vector2d last = atlas.on_page(n, image, {1.0, 1.0});
    EXPECT_NEAR(last.x() * page.width, place.x + image.width, 1e-9);
    EXPECT_NEAR(last.y() * page.height, place.y + image.height, 1e-9);
  }
}

TEST(TextureAtlas, RefusesWhatNoPageHolds) {
  EXPECT_THROW(pack_textures({Image(TextureAtlas::kLargest, 1)}), std::invalid_argument);
  EXPECT_THROW(pack_textures({Image()}), std::invalid_argument);
  EXPECT_TRUE(pack_textures({}).pages.empty());
}

}  // namespace
}  // namespace prospect::texture_atlas_test
