// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/texture_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace prospect::texture_pyramid_test {
namespace {

Image ramp(int width, int height) {
  Image image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) image.at(u, v) = static_cast<std::uint8_t>(3 * u + 10 * v);
  }
  return image;
}

TEST(TexturePyramid, GivesTexelsAtTheirCentresAndLinesBetween) {
  const Image image = ramp(8, 4);
  const TexturePyramid pyramid(image);
  for (int v = 0; v < 4; ++v) {
    for (int u = 0; u < 8; ++u) {
      EXPECT_FLOAT_EQ(pyramid.bilinear(0, (u + 0.5f) / 8, (v + 0.5f) / 4), image.at(u, v));
    }
  }
  EXPECT_NEAR(pyramid.bilinear(0, 3.0f / 8, 2.0f / 4), 0.25 * (16 + 19 + 26 + 29), 1e-3);
}

TEST(TexturePyramid, Repeats) {
  const TexturePyramid pyramid(ramp(5, 3));
  for (const float u : {0.03f, 0.5f, 0.97f}) {
    for (const float v : {0.04f, 0.6f, 0.95f}) {
      for (int level = 0; level < pyramid.levels(); ++level) {
        const float here = pyramid.bilinear(level, u, v);
        EXPECT_NEAR(pyramid.bilinear(level, u + 2.0f, v - 3.0f), here, 1e-3);
        EXPECT_NEAR(pyramid.bilinear(level, u - 1.0f, v + 1.0f), here, 1e-3);
      }
    }
  }
  // Half a texel beyond the edge lies half way to the texel of the other side.
  EXPECT_NEAR(pyramid.bilinear(0, 0.0f, 0.5f / 3), 0.5 * (0 + 12), 1e-3);
}

TEST(TexturePyramid, HalvesDownToTheMean) {
  const TexturePyramid pyramid(ramp(13, 6));  // 13x6, 7x3, 4x2, 2x1, 1x1
  EXPECT_EQ(pyramid.levels(), 5);
  const double mean = 3 * 6.0 + 10 * 2.5;
  EXPECT_NEAR(pyramid.bilinear(4, 0.3f, 0.7f), mean, 2.0);  // each level is rounded
  const float fine = pyramid.bilinear(1, 0.4f, 0.4f), coarse = pyramid.bilinear(2, 0.4f, 0.4f);
  EXPECT_NEAR(pyramid.mean_along(1.25f, 0.4f, 0.4f, 0.0f, 0.0f, 1), 0.75 * fine + 0.25 * coarse,
              1e-3);
  EXPECT_EQ(pyramid.mean_along(77.0f, 0.4f, 0.4f, 0.1f, 0.2f, 3), pyramid.bilinear(4, 0.4f, 0.4f));
  // Two taps: a quarter of the segment to either side.
  EXPECT_NEAR(pyramid.mean_along(0.0f, 0.4f, 0.5f, 0.2f, 0.1f, 2),
              0.5 * (pyramid.bilinear(0, 0.35f, 0.475f) + pyramid.bilinear(0, 0.45f, 0.525f)),
              1e-3);
}

TEST(TexturePyramid, RefusesAnEmptyImage) {
  EXPECT_THROW(TexturePyramid(Image{}), std::invalid_argument);
  Image torn(4, 4);
  torn.pixels.pop_back();
  EXPECT_THROW(TexturePyramid{torn}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::texture_pyramid_test
