// SPDX-License-Identifier: Apache-2.0
#include "perception/places/stereo_view.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/stereo_matcher.h"

namespace prospect {
namespace {

constexpr float kFactor = 1.2F;  // between levels
constexpr int kPyramidLevels = 3;

cv::Mat as_mat(const ImageView& image) {
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                 static_cast<std::size_t>(image.stride));
}

}  // namespace

int distance(const ViewDescriptor& a, const ViewDescriptor& b) {
  int bits = 0;
  for (std::size_t word = 0; word < a.size(); ++word) bits += std::popcount(a[word] ^ b[word]);
  return bits;
}

StereoView stereo_view(const StereoCamera& camera, const ImageView& left, const ImageView& right,
                       const StereoViewOptions& options) {
  for (const ImageView& image : {left, right}) {
    if (image.empty() || image.width != static_cast<int>(camera.left.width) ||
        image.height != static_cast<int>(camera.left.height)) {
      throw std::invalid_argument("stereo_view: expected images of the camera's size");
    }
  }
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(options.corners, kFactor, options.levels, 19, 0, 2,
                                               cv::ORB::HARRIS_SCORE, 31, options.least_contrast);
  std::vector<cv::KeyPoint> corners;
  cv::Mat descriptors;
  orb->detectAndCompute(as_mat(left), cv::noArray(), corners, descriptors);

  StereoView view;
  std::vector<Eigen::Vector2f> pixels;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    StereoView::Point point;
    point.pixel = {corners[i].pt.x, corners[i].pt.y};
    point.scale = std::pow(static_cast<double>(kFactor), corners[i].octave);
    std::memcpy(point.descriptor.data(), descriptors.ptr(static_cast<int>(i)),
                sizeof point.descriptor);
    view.points.push_back(point);
    pixels.emplace_back(corners[i].pt.x, corners[i].pt.y);
  }
  if (pixels.empty()) return view;
  const ImagePyramid left_pyramid(left, kPyramidLevels), right_pyramid(right, kPyramidLevels);
  for (const StereoMatch& match : match_stereo(left_pyramid, right_pyramid, pixels)) {
    StereoView::Point& point = view.points[static_cast<std::size_t>(match.index)];
    point.disparity = match.disparity;
    point.sigma_disparity = std::sqrt(match.variance);
  }
  return view;
}

}  // namespace prospect
