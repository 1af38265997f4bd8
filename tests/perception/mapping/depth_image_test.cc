// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/depth_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace prospect::depth_image_test {
namespace {

TEST(DepthImage, OfMillimetres) {
  // Rows three pixels apart; the third column belongs to somebody else.
  const std::vector<std::uint16_t> raw = {0, 1000, 7, 65535, 2500, 7, 299, 300, 7, 8000, 8001, 7};
  const DepthImage image = depth_image(raw.data(), 2, 4, 3, 0.001);
  ASSERT_TRUE(image.whole());
  EXPECT_TRUE(std::isnan(image.at(0, 0)));
  EXPECT_FLOAT_EQ(image.at(1, 0), 1.0F);
  EXPECT_TRUE(std::isnan(image.at(0, 1)));
  EXPECT_FLOAT_EQ(image.at(1, 1), 2.5F);
  EXPECT_TRUE(std::isnan(image.at(0, 2)));
  EXPECT_FLOAT_EQ(image.at(1, 2), 0.3F);
  EXPECT_FLOAT_EQ(image.at(0, 3), 8.0F);
  EXPECT_TRUE(std::isnan(image.at(1, 3)));
}

TEST(DepthImage, SixtyFiveThousandIsInvalidWhateverTheUnit) {
  const std::uint16_t raw[] = {65535, 65534, 0, 1};
  const DepthImage image = depth_image(raw, 4, 1, 4, 1e-4, {0.0, 10.0});
  EXPECT_TRUE(std::isnan(image.at(0, 0)));
  EXPECT_FLOAT_EQ(image.at(1, 0), 6.5534F);
  EXPECT_TRUE(std::isnan(image.at(2, 0)));  // 0 is inside of the range
  EXPECT_FLOAT_EQ(image.at(3, 0), 1e-4F);
}

TEST(DepthImage, OfMetres) {
  const float inf = std::numeric_limits<float>::infinity();
  const float metres[] = {1.5F, 0.0F, -1.0F, inf, -inf, DepthImage::kInvalid, 1e30F, 0.29F};
  const DepthImage image = depth_image(metres, 8, 1, 8);
  EXPECT_EQ(image.at(0, 0), 1.5F);
  for (int u = 1; u < 8; ++u) EXPECT_TRUE(std::isnan(image.at(u, 0))) << u;
}

TEST(DepthImage, WithoutPixelsIsEmpty) {
  const std::uint16_t raw[] = {1000};
  EXPECT_FALSE(depth_image(raw, 0, 1, 1, 0.001).whole());
  EXPECT_FALSE(depth_image(raw, 1, -1, 1, 0.001).whole());
  EXPECT_FALSE(depth_image(raw, 1, 1, 0, 0.001).whole());
  EXPECT_FALSE(depth_image(static_cast<const float*>(nullptr), 1, 1, 1).whole());
  DepthImage torn(4, 4);
  torn.depth.pop_back();
  EXPECT_FALSE(torn.whole());
}

TEST(DepthImage, SameMeansSameBits) {
  DepthImage a(3, 2, 1.0F), b = a;
  a.at(0, 0) = b.at(0, 0) = DepthImage::kInvalid;
  EXPECT_TRUE(a.same(b));
  b.at(2, 1) = 1.0001F;
  EXPECT_FALSE(a.same(b));
  EXPECT_FALSE(a.same(DepthImage(2, 3, 1.0F)));
}

TEST(DepthImage, RaysProject) {
  const PinholeCamera camera{450, 460, 310, 230, 640, 480};
  const Eigen::Vector3d ray = pixel_ray(camera, 17.0, 401.0);
  EXPECT_EQ(ray.z(), 1.0);
  EXPECT_TRUE(camera.project(2.7 * ray).isApprox(Eigen::Vector2d(17.0, 401.0), 1e-12));
}

}  // namespace
}  // namespace prospect::depth_image_test
