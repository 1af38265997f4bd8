// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/stereo_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/perception/rendered_room.h"

namespace prospect::stereo_depth_test {
namespace {

using test::RenderedRoom;

StereoCamera camera() {
  StereoCamera c;
  c.left = {220.0, 220.0, 159.5, 119.5, 320.0, 240.0};
  c.baseline = 0.12;
  return c;
}

Eigen::Isometry3d pose() { return RenderedRoom::looking(-1.0, -0.3, 1.0, 0.1); }

double share_valid(const DepthImage& image) {
  const auto valid = std::count_if(image.depth.begin(), image.depth.end(),
                                   [](float z) { return std::isfinite(z); });
  return static_cast<double>(valid) / static_cast<double>(image.depth.size());
}

TEST(StereoDepth, MeasuresARoomAsWellAsItSays) {
  const RenderedRoom room;
  const auto pair = room.render(camera(), pose(), 2.0, 5);
  StereoDepth stereo(camera());
  const DepthImage image = stereo.depth(pair.left.view(), pair.right.view());
  ASSERT_TRUE(image.whole());
  EXPECT_NEAR(stereo.noise(), 0.4 / (220.0 * 0.12), 1e-12);
  EXPECT_NEAR(stereo.range().max, 0.1 / stereo.noise(), 1e-9);
  std::vector<double> off;  // in the standard deviations that are claimed
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const double z = image.at(u, v);
      if (!std::isfinite(z)) continue;
      EXPECT_TRUE(stereo.range().holds(z));
      const double truth = room.depth(camera().left, pose(), u, v);
      off.push_back(std::abs(z - truth) / (stereo.noise() * truth * truth));
    }
  }
  EXPECT_GT(share_valid(image), 0.8);
  const auto below = [&](double limit) {
    const auto n = std::count_if(off.begin(), off.end(), [=](double e) { return e < limit; });
    return static_cast<double>(n) / static_cast<double>(off.size());
  };
  // A Gaussian error has 0.68 and 0.95; the edges of the pillar are farther off.
  EXPECT_GT(below(1.0), 0.68);
  EXPECT_GT(below(2.0), 0.93);
  EXPECT_TRUE(image.same(StereoDepth(camera()).depth(pair.left.view(), pair.right.view())));
}

/// A plain wall, and the noise of both cameras on it.
RenderedRoom::Pair plain() { return RenderedRoom(0.0).render(camera(), pose(), 2.0, 3); }

TEST(StereoDepth, OfAPlainWallNothingIsMeasured) {
  const auto pair = plain();
  StereoDepth stereo(camera());
  EXPECT_LT(share_valid(stereo.depth(pair.left.view(), pair.right.view())), 0.002);
  const Image grey(320, 240, 100);
  EXPECT_EQ(share_valid(stereo.depth(grey.view(), grey.view())), 0.0);
}

TEST(StereoDepth, WhatIsPlainBetweenTexturesIsNotFilledIn) {
  // Texture above and below; the matching alone carries its disparities on over all rows between.
  const auto texture = RenderedRoom().render(camera(), pose(), 2.0, 5);
  auto pair = plain();
  for (int v = 0; v < 240; ++v) {
    if (v >= 80 && v < 160) continue;
    for (int u = 0; u < 320; ++u) {
      pair.left.at(u, v) = texture.left.at(u, v);
      pair.right.at(u, v) = texture.right.at(u, v);
    }
  }
  const auto share_between = [&](const StereoDepthOptions& options) {
    const DepthImage image =
        StereoDepth(camera(), options).depth(pair.left.view(), pair.right.view());
    int valid = 0;
    for (int v = 90; v < 150; ++v) {
      for (int u = 0; u < 320; ++u) valid += std::isfinite(image.at(u, v));
    }
    return valid / (60.0 * 320.0);
  };
  EXPECT_LT(share_between({}), 0.01);
  StereoDepthOptions matched_only;
  matched_only.least_correlation = -1.0;
  EXPECT_GT(share_between(matched_only), 0.05);
}

TEST(StereoDepth, EdgesAlongTheRowsSayNothing) {
  std::mt19937 generator(7);
  Image left(320, 240), right(320, 240);
  for (int v = 0; v < 240; ++v) {
    const auto grey = static_cast<std::uint8_t>(60 + generator() % 120);
    for (int u = 0; u < 320; ++u) {
      left.at(u, v) = static_cast<std::uint8_t>(grey + generator() % 5);
      right.at(u, v) = static_cast<std::uint8_t>(grey + generator() % 5);
    }
  }
  EXPECT_LT(share_valid(StereoDepth(camera()).depth(left.view(), right.view())), 0.002);
}

TEST(StereoDepth, SeesTheWholeLeftImageButForWhatTheRightOneLacks) {
  // Noise that both cameras see alike, ten pixels apart.
  std::mt19937 generator(7);
  Image left(320, 240), right(320, 240);
  for (std::uint8_t& grey : left.pixels) grey = static_cast<std::uint8_t>(generator() % 256);
  for (std::uint8_t& grey : right.pixels) grey = static_cast<std::uint8_t>(generator() % 256);
  for (int v = 0; v < 240; ++v) {
    for (int u = 10; u < 320; ++u) right.at(u - 10, v) = left.at(u, v);
  }
  const DepthImage image = StereoDepth(camera()).depth(left.view(), right.view());
  for (int v = 20; v < 220; v += 20) {
    EXPECT_FALSE(std::isfinite(image.at(5, v)));
    for (int u = 20; u < 310; u += 10) {
      EXPECT_NEAR(image.at(u, v), 220.0 * 0.12 / 10.0, 0.02) << u << " " << v;
    }
  }
}

TEST(StereoDepth, ImagesOfAnotherSizeHaveNoDepth) {
  StereoDepth stereo(camera());
  const Image right(320, 240, 100), small(160, 120, 100);
  EXPECT_FALSE(stereo.depth(small.view(), small.view()).whole());
  EXPECT_FALSE(stereo.depth(right.view(), small.view()).whole());
  EXPECT_FALSE(stereo.depth({}, right.view()).whole());
}

TEST(StereoDepth, WrongOptionsAreRefused) {
  const auto refuses = [](auto change) {
    StereoDepthOptions options;
    change(options);
    EXPECT_THROW(StereoDepth(camera(), options), std::invalid_argument);
  };
  refuses([](StereoDepthOptions& o) { o.nearest = 0.0; });
  refuses([](StereoDepthOptions& o) { o.sigma_disparity = std::nan(""); });
  refuses([](StereoDepthOptions& o) { o.most_disparities = 0; });
  refuses([](StereoDepthOptions& o) { o.window = 4; });
  refuses([](StereoDepthOptions& o) { o.block = 1; });
  refuses([](StereoDepthOptions& o) { o.most_error = 1e-3; });
  StereoCamera none = camera();
  none.baseline = 0.0;
  EXPECT_THROW(StereoDepth{none}, std::invalid_argument);
}

}  // namespace
}  // namespace prospect::stereo_depth_test
