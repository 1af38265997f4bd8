// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/images/image_codec.h"

#include <gtest/gtest.h>
#include <link.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace prospect::image_codec_test {
namespace {

cv::Mat decoded(const std::vector<std::uint8_t>& bytes, int flags = cv::IMREAD_UNCHANGED) {
  return decode_pixels(
      cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data())),
      flags);
}

/// Whether these are the same pixels, of the same type.
bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

/// A slope of greys from 0 to `most`.
template <typename Value>
cv::Mat slope(int type, double most) {
  cv::Mat image(40, 50, type);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      image.at<Value>(v, u) = static_cast<Value>(most * (u + v) / 88.0);
    }
  }
  return image;
}

cv::Mat grey() { return slope<std::uint8_t>(CV_8UC1, 255.0); }

/// What follows `name` in the path of the library of that name that is loaded: ".so.406". Empty:
/// none is.
std::string loaded_version(const std::string& name) {
  std::pair<std::string, std::string> wanted_found{name, ""};
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        auto& [wanted, found] = *static_cast<std::pair<std::string, std::string>*>(data);
        const std::string path = info->dlpi_name;
        const std::size_t at = path.rfind(wanted);
        if (at != std::string::npos) found = path.substr(at + wanted.size());
        return 0;
      },
      &wanted_found);
  return wanted_found.second;
}

// The first test: this program is not linked to the codecs, so that nothing has loaded them yet.
TEST(ImageCodec, ManyThreadsMayBeTheFirstToUseIt) {
  ASSERT_EQ(loaded_version("libopencv_imgcodecs"), "");
  const cv::Mat image = grey();
  constexpr int kThreads = 8;
  std::atomic<int> ready = 0, right = 0;
  std::vector<std::thread> threads;
  for (int n = 0; n < kThreads; ++n) {
    threads.emplace_back([&] {
      ++ready;
      while (ready < kThreads) std::this_thread::yield();
      right += same(decoded(encode_pixels(".png", image)), image);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, kThreads);
  EXPECT_EQ(loaded_version("libopencv_imgcodecs"), loaded_version("libopencv_core"));
}

TEST(ImageCodec, WhatIsLosslessComesBackAsItWas) {
  cv::Mat colours(30, 20, CV_8UC3, cv::Scalar(10, 120, 230));
  colours.at<cv::Vec3b>(3, 4) = {1, 2, 3};
  EXPECT_TRUE(same(decoded(encode_pixels(".png", grey())), grey()));
  EXPECT_TRUE(same(decoded(encode_pixels(".png", colours)), colours));
  EXPECT_TRUE(same(decoded(encode_pixels(".bmp", colours)), colours));
  const cv::Mat depth = slope<std::uint16_t>(CV_16UC1, 65535.0);
  EXPECT_TRUE(same(decoded(encode_pixels(".png", depth)), depth));
  EXPECT_TRUE(same(decoded(encode_pixels(".tiff", depth)), depth));
}

TEST(ImageCodec, JpegIsNearlyTheImage) {
  const std::vector<std::uint8_t> bytes =
      encode_pixels(".jpg", grey(), {cv::IMWRITE_JPEG_QUALITY, 90});
  const cv::Mat image = decoded(bytes);
  ASSERT_EQ(image.size(), grey().size());
  ASSERT_EQ(image.type(), CV_8UC1);
  EXPECT_LT(cv::norm(image, grey(), cv::NORM_L1) / static_cast<double>(image.total()), 1.0);
}

TEST(ImageCodec, ParametersAndFlagsAreHeeded) {
  const auto of_quality = [](int quality) {
    return encode_pixels(".jpg", grey(), {cv::IMWRITE_JPEG_QUALITY, quality}).size();
  };
  EXPECT_LT(of_quality(10), of_quality(95));
  const std::vector<std::uint8_t> bytes = encode_pixels(".png", grey());
  EXPECT_EQ(decoded(bytes, cv::IMREAD_COLOR).channels(), 3);
  EXPECT_EQ(decoded(bytes, cv::IMREAD_GRAYSCALE).channels(), 1);
}

TEST(ImageCodec, WhatIsNoImageIsEmpty) {
  EXPECT_TRUE(decoded({'n', 'o', ' ', 'i', 'm', 'a', 'g', 'e'}).empty());
}

TEST(ImageCodec, ThrowsAsOpenCvDoes) {
  EXPECT_THROW(encode_pixels(".nothing", grey()), cv::Exception);
  EXPECT_THROW(encode_pixels(".png", cv::Mat()), cv::Exception);
}

}  // namespace
}  // namespace prospect::image_codec_test
