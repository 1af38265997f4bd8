// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_pyramid.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace prospect::image_pyramid_test {
namespace {

TEST(ImagePyramid, LevelsAreHalvesAndPixelsKeepTheirPlace) {
  // A ramp: pixel (u, v) of level l must show what (2^l u, 2^l v) of the image does.
  Image image(200, 120);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) image.at(u, v) = static_cast<std::uint8_t>(u + v / 2);
  }
  const ImagePyramid pyramid(image.view(), 3);
  ASSERT_EQ(pyramid.levels(), 3);
  EXPECT_EQ(pyramid.level(2).width, 50);
  EXPECT_EQ(pyramid.level(2).height, 30);
  for (int l = 0; l < 3; ++l) {
    const int scale = 1 << l;
    for (int v = 5; v < pyramid.level(l).height - 5; ++v) {
      for (int u = 5; u < pyramid.level(l).width - 5; ++u) {
        ASSERT_NEAR(pyramid.level(l).row(v)[u], scale * u + scale * v / 2.0, 1.01) << l;
      }
    }
  }
}

TEST(ImagePyramid, RespectsTheStride) {
  Image wide(64, 40);
  for (int v = 0; v < 40; ++v) {
    for (int u = 0; u < 64; ++u) wide.at(u, v) = static_cast<std::uint8_t>(u * 3 + v);
  }
  const ImagePyramid part(ImageView{wide.pixels.data() + 10, 30, 40, 64}, 1);
  EXPECT_EQ(part.level(0).row(7)[4], wide.at(14, 7));
}

TEST(ImagePyramid, StopsBeforeLevelsAreTooSmallAndRefusesNothing) {
  const Image image(100, 50, 10);
  EXPECT_EQ(ImagePyramid(image.view(), 6).levels(), 2);  // 100x50, 50x25; 25x13 is too low
  EXPECT_THROW(ImagePyramid(ImageView{}, 3), std::invalid_argument);
  EXPECT_THROW(ImagePyramid(image.view(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::image_pyramid_test
