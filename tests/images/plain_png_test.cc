// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/images/plain_png.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/images/checked_png.h"
#include "adapters/formats/images/image_codec.h"

namespace prospect::plain_png_test {
namespace {

cv::Mat noise(int rows, int cols, int type) {
  std::mt19937 random(7);
  cv::Mat image(rows, cols, type);
  for (int v = 0; v < rows; ++v) {
    for (std::size_t i = 0; i < cols * image.elemSize(); ++i) {
      image.ptr<std::uint8_t>(v)[i] = static_cast<std::uint8_t>(random());
    }
  }
  return image;
}

TEST(PlainPng, HoldsThePixelsThatItIsMadeOf) {
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3, CV_8UC4}) {
    const cv::Mat image = noise(13, 37, type);
    const std::vector<std::uint8_t> bytes = plain_png(image);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    check_png_pixels("it", checked_png("it", text, 1000));
    const cv::Mat read = decode_pixels(cv::Mat(bytes, true).reshape(1, 1), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(read.type(), type);
    ASSERT_EQ(read.size(), image.size());
    EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0) << type;
    EXPECT_EQ(plain_png(image), bytes);
  }
}

TEST(PlainPng, APartOfAnImageHasItsOwnRows) {
  const cv::Mat image = noise(20, 20, CV_8UC3);
  const cv::Mat part = image(cv::Rect(3, 4, 5, 6));
  ASSERT_FALSE(part.isContinuous());
  EXPECT_EQ(plain_png(part), plain_png(part.clone()));
}

TEST(PlainPng, OtherPixelsHaveNone) {
  EXPECT_TRUE(plain_png(cv::Mat()).empty());
  EXPECT_TRUE(plain_png(noise(3, 3, CV_32FC1)).empty());
  EXPECT_TRUE(plain_png(noise(3, 3, CV_16UC3)).empty());
}

}  // namespace
}  // namespace prospect::plain_png_test
