// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_pyramid.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace prospect {

ImagePyramid::ImagePyramid(const ImageView& image, int levels, int smallest) {
  if (image.empty()) throw std::invalid_argument("image pyramid: the image is empty");
  if (levels < 1) throw std::invalid_argument("image pyramid: expected at least one level");
  // OpenCV does not write through this header.
  cv::Mat grey(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
               static_cast<std::size_t>(image.stride));
  levels_.reserve(levels);
  for (int l = 0; l < levels; ++l) {
    if (l > 0) {
      const int width = (grey.cols + 1) / 2, height = (grey.rows + 1) / 2;
      if (width < smallest || height < smallest) break;
      cv::Mat half;
      cv::pyrDown(grey, half, cv::Size(width, height));
      grey = half;
    }
    PyramidLevel& level = levels_.emplace_back();
    level.width = grey.cols;
    level.height = grey.rows;
    level.pixels.resize(static_cast<Eigen::Index>(grey.cols) * grey.rows);
    cv::Mat out(grey.rows, grey.cols, CV_32F, level.pixels.data());
    grey.convertTo(out, CV_32F);
  }
}

}  // namespace prospect
