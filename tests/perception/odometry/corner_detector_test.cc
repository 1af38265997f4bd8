// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/corner_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "perception/odometry/image_noise.h"

namespace prospect::corner_detector_test {
namespace {

Image checkerboard(int width, int height, int square, int low, int high) {
  Image image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      image.at(u, v) = static_cast<std::uint8_t>((u / square + v / square) % 2 ? high : low);
    }
  }
  return image;
}

TEST(CornerDetector, FindsTheCornersOfACheckerboard) {
  const Image board = checkerboard(640, 480, 40, 80, 180);
  const auto corners = detect_corners(board.view());
  ASSERT_GT(corners.size(), 80u);
  for (const Eigen::Vector2f& c : corners) {
    // Squares meet between pixels 40 k - 1 and 40 k.
    const float du = std::abs(c.x() + 0.5f - 40.0f * std::round((c.x() + 0.5f) / 40.0f));
    const float dv = std::abs(c.y() + 0.5f - 40.0f * std::round((c.y() + 0.5f) / 40.0f));
    EXPECT_LE(du, 2.5f);
    EXPECT_LE(dv, 2.5f);
  }
}

TEST(CornerDetector, NothingOnABlankWallWithNoiseOfTwoGreyLevels) {
  Image wall(640, 480);
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(128.0, 2.0);
  for (auto& p : wall.pixels) p = static_cast<std::uint8_t>(std::lround(noise(generator)));
  EXPECT_TRUE(detect_corners(wall.view()).empty());
}

TEST(CornerDetector, FindsAsMuchInADarkerImage) {
  // A smooth pattern with noise, and the same with half of the light.
  std::mt19937 generator(4);
  std::normal_distribution<double> noise(0.0, 3.0);
  Image bright(320, 240), dark(320, 240);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const double grey = 130.0 + 25.0 * std::sin(0.21 * u) * std::sin(0.17 * v) + noise(generator);
      bright.at(u, v) = static_cast<std::uint8_t>(std::lround(grey));
      dark.at(u, v) = static_cast<std::uint8_t>(std::lround(grey / 2.0));
    }
  }
  const std::size_t found = detect_corners(bright.view()).size();
  ASSERT_GT(found, 50u);
  EXPECT_GT(detect_corners(dark.view()).size(), 9 * found / 10);
}

TEST(CornerDetector, TheFloorIsInVariancesOfTheNoise) {
  // I = a sin(k u) + a sin(k v) with a period of 7 px, the block's: central differences have the
  // amplitude a sin k, so both eigenvalues are (a sin k)^2 / 2 everywhere.
  const double a = 20.0, k = 2.0 * M_PI / 7.0;
  Image waves(120, 120);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 120; ++u) {
      waves.at(u, v) =
          static_cast<std::uint8_t>(std::lround(128.0 + a * std::sin(k * u) + a * std::sin(k * v)));
    }
  }
  const double noise = image_noise(waves.view());
  const double strength = 0.5 * std::pow(a * std::sin(k) / noise, 2);
  CornerDetectorOptions options;
  options.cells = 4;
  options.min_strength_over_noise = 0.95 * strength;
  EXPECT_FALSE(detect_corners(waves.view(), {}, options).empty());
  options.min_strength_over_noise = 1.05 * strength;
  EXPECT_TRUE(detect_corners(waves.view(), {}, options).empty());
}

TEST(CornerDetector, OneACellFarFromWhatIsThere) {
  const Image board = checkerboard(640, 480, 16, 60, 200);
  CornerDetectorOptions options;
  options.cells = 200;
  const double cell = corner_cell(640, 480, options);
  const auto all = detect_corners(board.view(), {}, options);
  EXPECT_GT(all.size(), 120u);
  EXPECT_LE(all.size(), 240u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE((all[i] - all[j]).norm(), 0.5 * cell);
  }
  // Points on the left half: new corners only on the right, or half a cell away.
  std::vector<Eigen::Vector2f> held;
  for (float v = 0; v < 480; v += 10) {
    for (float u = 0; u < 320; u += 10) held.emplace_back(u, v);
  }
  const auto rest = detect_corners(board.view(), held, options);
  EXPECT_GT(rest.size(), 50u);
  for (const Eigen::Vector2f& c : rest) EXPECT_GT(c.x(), 320.0f);
  EXPECT_EQ(detect_corners(board.view(), {}, options), all);  // same image, same corners
  EXPECT_THROW(detect_corners(ImageView{}), std::invalid_argument);
}

TEST(CornerDetector, ACornerIsTheSameWhateverOtherCellsHold) {
  // Strength is looked at where cells are free: the edge of such a part is none of the image.
  Image image(320, 240);
  std::mt19937 generator(5);
  for (auto& p : image.pixels) p = static_cast<std::uint8_t>(generator() >> 24);
  CornerDetectorOptions options;
  options.cells = 48;
  options.min_strength_over_noise = 0.0;
  const auto all = detect_corners(image.view(), {}, options);
  const auto cell = static_cast<float>(corner_cell(320, 240, options));
  ASSERT_GT(all.size(), 20u);
  int compared = 0;
  for (const Eigen::Vector2f& c : all) {
    // Every cell but that of this corner is full, by a point as far from it as can be.
    std::vector<Eigen::Vector2f> others;
    for (const Eigen::Vector2f& o : all) {
      const bool same = std::floor(o.x() / cell) == std::floor(c.x() / cell) &&
                        std::floor(o.y() / cell) == std::floor(c.y() / cell);
      if (!same) others.push_back(o);
    }
    const auto alone = detect_corners(image.view(), others, options);
    for (const Eigen::Vector2f& found : alone) compared += found == c;
  }
  EXPECT_EQ(compared, static_cast<int>(all.size()));
}

}  // namespace
}  // namespace prospect::corner_detector_test
