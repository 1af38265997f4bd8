// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/images/image_codec.h"
#include "models/image.h"

namespace prospect::test {

// cv::imwrite() and cv::imread() for tests, by the codecs that are loaded at their first use: every
// file of tests is a start of its program, and few of them need a codec.

/// Writes `pixels` to the file `path` in the format of its ending; throws where that fails.
inline void write_image(const std::string& path, const cv::Mat& pixels) {
  const std::vector<std::uint8_t> bytes =
      encode_pixels(std::filesystem::path(path).extension().string(), pixels);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  if (bytes.empty() || !file.flush()) throw std::runtime_error("cannot write " + path);
}

/// The pixels of `image`, which must outlive them.
inline cv::Mat pixels_of(const Image& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
}
inline void write_image(const std::string& path, const Image& image) {
  write_image(path, pixels_of(image));
}

/// The pixels of `bytes`, the content of an image file in a row (std::string, std::vector), as
/// `flags` (cv::ImreadModes) ask for them; empty where they are no image.
template <typename Bytes>
cv::Mat decoded(const Bytes& bytes, int flags) {
  const cv::Mat row(1, static_cast<int>(bytes.size()), CV_8UC1,
                    const_cast<void*>(static_cast<const void*>(bytes.data())));
  return decode_pixels(row, flags);
}

/// The pixels of the file `path`; empty where it cannot be read.
inline cv::Mat read_image(const std::string& path, int flags) {
  std::ifstream file(path, std::ios::binary);
  return decoded(std::string(std::istreambuf_iterator<char>(file), {}), flags);
}

}  // namespace prospect::test
