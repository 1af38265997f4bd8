// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/field_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "adapters/formats/images/image_codec.h"

namespace prospect {

FieldPicture field_picture(const CostToGoPicture& picture, int max_pixels) {
  const GridFrame& fine = picture.frame;
  FieldPicture small;
  const auto sized = [&] {
    return fine.width > 0 && fine.height > 0 &&
           picture.seconds.size() == static_cast<std::size_t>(fine.size());
  };
  if (!sized()) return small;
  int side = 1;
  while (frame_of_blocks(fine, side).size() > max_pixels && side < fine.width + fine.height) ++side;
  small.frame = frame_of_blocks(fine, side);

  constexpr float kNone = -1.0F;
  std::vector<float> lowest(static_cast<std::size_t>(small.frame.size()), kNone);
  for (int n = 0; n < fine.size(); ++n) {
    const float value = picture.seconds[static_cast<std::size_t>(n)];
    if (!(std::isfinite(value) && value >= 0.0F)) continue;
    const Cell c = fine.at(n);
    float& pixel = lowest[static_cast<std::size_t>(
        small.frame.index({floor_divide(c.i, side), floor_divide(c.j, side)}))];
    pixel = pixel == kNone ? value : std::min(pixel, value);
  }
  small.most = *std::max_element(lowest.begin(), lowest.end());
  if (small.most < 0.0) return {};
  const double per_second = small.most > 0.0 ? 254.0 / small.most : 0.0;
  cv::Mat image(small.frame.height, small.frame.width, CV_8UC1);
  for (int n = 0; n < small.frame.size(); ++n) {
    const float value = lowest[static_cast<std::size_t>(n)];
    image.at<std::uint8_t>(small.frame.height - 1 - n / small.frame.width, n % small.frame.width) =
        value == kNone ? 0 : static_cast<std::uint8_t>(1 + std::lround(per_second * value));
  }
  small.png = encode_pixels(".png", image, {cv::IMWRITE_PNG_COMPRESSION, 9});
  return small;
}

}  // namespace prospect
