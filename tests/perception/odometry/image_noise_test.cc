// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace prospect::image_noise_test {
namespace {

/// A pattern of this strength [grey levels], seen with this noise.
Image noisy(double pattern, double noise) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, noise);
  Image image(320, 240);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      // Waves, and a dark board with edges.
      double grey = 120.0 + pattern * std::sin(0.13 * u + 0.05 * v) * std::cos(0.11 * v);
      if (pattern > 0.0 && u > 100 && u < 180 && v > 60 + 0.3 * u) grey -= 60.0;
      image.at(u, v) = static_cast<std::uint8_t>(std::lround(grey + normal(generator)));
    }
  }
  return image;
}

TEST(ImageNoise, IsThatOfTheImageWhateverItShows) {
  for (const double noise : {1.0, 2.0, 5.0}) {
    const double whole = std::sqrt(noise * noise + 1.0 / 12.0);  // rounded to grey levels
    EXPECT_NEAR(image_noise(noisy(0.0, noise).view()), whole, 0.07 * whole);
    EXPECT_NEAR(image_noise(noisy(30.0, noise).view()), whole, 0.12 * whole);
  }
}

TEST(ImageNoise, IsAtLeastThatOfRounding) {
  EXPECT_NEAR(image_noise(noisy(0.0, 0.0).view()), 0.2887, 1e-9);
  EXPECT_NEAR(image_noise(Image(2, 2).view()), 0.2887, 1e-9);
  EXPECT_NEAR(image_noise(ImageView{}), 0.2887, 1e-9);
}

}  // namespace
}  // namespace prospect::image_noise_test
