// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frozen_images.h"

#include <gtest/gtest.h>

namespace prospect::frozen_images_test {
namespace {

TEST(FrozenImages, SaysWhichImageCameTwice) {
  const Image a(40, 30, 1), b(40, 30, 2), c(40, 30, 3);
  Image nearly = a;
  nearly.at(39, 29) = 2;
  FrozenImages images;
  EXPECT_EQ(images.find(a.view(), b.view()), "");
  images.keep(a.view(), b.view());
  EXPECT_EQ(images.find(a.view(), b.view()), "the images are frozen");
  EXPECT_EQ(images.find(a.view(), c.view()), "the left image is frozen");
  EXPECT_EQ(images.find(c.view(), b.view()), "the right image is frozen");
  EXPECT_EQ(images.find(nearly.view(), c.view()), "");
  EXPECT_EQ(images.find(Image(30, 40, 1).view(), c.view()), "");
}

TEST(FrozenImages, CopiesRowsThatHaveGaps) {
  Image wide(8, 3, 9);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 5; ++u) wide.at(u, v) = static_cast<std::uint8_t>(10 * v + u);
  }
  const ImageView view{wide.pixels.data(), 5, 3, 8};
  FrozenImages images;
  images.keep(view, view);
  wide.at(6, 1) = 200;  // between two rows of the view
  EXPECT_EQ(images.find(view, view), "the images are frozen");
  EXPECT_EQ(images.left()->at(4, 2), 24);
}

}  // namespace
}  // namespace prospect::frozen_images_test
