// SPDX-License-Identifier: Apache-2.0
// The codecs where there are none: this program's are named by a file that is nowhere
// (tests/CMakeLists.txt).
#include <iostream>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/images/plain_png.h"

namespace {

template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const prospect::InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

int main() {
  int failures = 0;
  const auto expect = [&](bool what, std::string_view name) {
    if (what) return;
    std::cerr << "FAILED: " << name << '\n';
    ++failures;
  };
  const cv::Mat image(4, 5, CV_8UC3, cv::Scalar(10, 120, 230));
  prospect::load_image_codecs_if_there();
  const std::vector<std::uint8_t> png = prospect::encode_pixels(".png", image);
  expect(!png.empty() && png == prospect::plain_png(image), "PNG is written without codecs");
  expect(prospect::encode_pixels(".jpg", image).empty(), "JPEG is not");
  for (const std::string& said : {refusal([] { prospect::load_image_codecs(); }), refusal([&] {
                                    prospect::decode_pixels(cv::Mat(png, true).reshape(1, 1), -1);
                                  })}) {
    expect(said.find("expected OpenCV's codecs of images") != std::string::npos, said);
  }
  return failures;
}
