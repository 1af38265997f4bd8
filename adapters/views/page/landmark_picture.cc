// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/page/landmark_picture.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "adapters/formats/images/image_codec.h"
#include "adapters/views/page/binary_text.h"

namespace prospect {

LandmarkPicture landmark_picture(int frame, const Image& image,
                                 const std::vector<LandmarkSighting>& sightings, int max_width) {
  constexpr int kQuality = 70;  // of JPEG
  const double scale = std::min(1.0, static_cast<double>(max_width) / image.width);
  LandmarkPicture picture;
  picture.frame = frame;
  picture.width = static_cast<int>(std::lround(scale * image.width));
  picture.height = static_cast<int>(std::lround(scale * image.height));
  // Read only; OpenCV has no view of constant pixels.
  const cv::Mat full(image.height, image.width, CV_8U,
                     const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat small;
  cv::resize(full, small, cv::Size(picture.width, picture.height), 0, 0, cv::INTER_AREA);
  picture.jpeg = encode_pixels(".jpg", small, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  for (const LandmarkSighting& s : sightings) {
    picture.features.push_back({static_cast<float>(scale * s.pixel.x()),
                                static_cast<float>(scale * s.pixel.y()),
                                s.made      ? 1
                                : s.tracked ? 0
                                            : 2});
  }
  return picture;
}

nlohmann::ordered_json pictures_json(const std::vector<LandmarkPicture>& pictures) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LandmarkPicture& p : pictures) {
    BinaryText jpeg, features;
    jpeg.add_bytes(p.jpeg);
    for (const LandmarkPicture::Feature& f : p.features) {
      features.add_float(f.u);
      features.add_float(f.v);
      features.add_float(f.kind);
    }
    json.push_back({{"frame", p.frame},
                    {"width", p.width},
                    {"height", p.height},
                    {"jpeg", jpeg.base64()},
                    {"features", features.base64()}});
  }
  return json;
}

}  // namespace prospect
