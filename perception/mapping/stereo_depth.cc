// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "models/parameter_check.h"

namespace prospect {
namespace {

constexpr const char* kOwner = "stereo depth";
constexpr int kSixteenths = 16;  // of a pixel, OpenCV's unit of disparities
constexpr int kStep = 16;        // their number is a multiple of it
// OpenCV's recommendation for a pixel of a block: what a step of the disparity costs by 1 px, by
// more.
constexpr int kSmallStep = 8, kLargeStep = 32;
constexpr int kMostSlope = 31;  // [grey levels]: steeper ones count as much
// Variance of a slope, half the difference of two grey levels, by their rounding.
constexpr float kRounding = 1.0F / 24.0F;

cv::Mat view_of(const ImageView& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                 static_cast<std::size_t>(image.stride));
}

/// Slopes of the grey levels along the row [grey levels/px].
void row_slope(const cv::Mat& image, cv::Mat& slope) {
  const cv::Mat halves = (cv::Mat_<float>(1, 3) << -0.5F, 0.0F, 0.5F);
  cv::filter2D(image, slope, CV_32F, halves, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
}

void check_side(const char* name, int side) {
  check_parameter(side >= 3 && side <= 31 && side % 2 == 1, kOwner, name, side, "odd, 3 to 31 px");
}

}  // namespace

struct StereoDepth::Matcher {
  int disparities = 0;
  cv::Ptr<cv::StereoSGBM> search;
  cv::Mat left, right;  // with a border of `disparities` columns on the left
  cv::Mat disparity;    // of `left`, in sixteenths
  cv::Mat slope, right_slope, matched_slope;
  cv::Mat mean, matched_mean, square, matched_square, correlation;  // over blocks

  void match(const cv::Mat& left_image, const cv::Mat& right_image);
  void correlate(const cv::Mat& left_image, const cv::Mat& right_image, int block);
};

void StereoDepth::Matcher::match(const cv::Mat& left_image, const cv::Mat& right_image) {
  // The search leaves out the columns from which the largest disparity leads out of the right
  // image. With a border they are searched, too.
  cv::copyMakeBorder(left_image, left, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right_image, right, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
  search->compute(left, right, disparity);
}

/// Of the slopes around each pixel with those around its match.
void StereoDepth::Matcher::correlate(const cv::Mat& left_image, const cv::Mat& right_image,
                                     int block) {
  row_slope(left_image, slope);
  row_slope(right_image, right_slope);
  matched_slope.create(slope.size(), CV_32F);
  for (int v = 0; v < slope.rows; ++v) {
    const auto* d = disparity.ptr<std::int16_t>(v) + disparities;
    const auto* from = right_slope.ptr<float>(v);
    auto* to = matched_slope.ptr<float>(v);
    for (int u = 0; u < slope.cols; ++u) {
      const int at = kSixteenths * u - d[u];
      const int whole = at / kSixteenths;
      const float rest = static_cast<float>(at % kSixteenths) / kSixteenths;
      const bool inside = d[u] > 0 && at >= 0;
      to[u] = inside ? from[whole] + rest * (from[whole + 1] - from[whole]) : 0.0F;
    }
  }
  const cv::Size size(block, block);
  cv::boxFilter(slope, mean, CV_32F, size);
  cv::boxFilter(matched_slope, matched_mean, CV_32F, size);
  cv::sqrBoxFilter(slope, square, CV_32F, size);
  cv::sqrBoxFilter(matched_slope, matched_square, CV_32F, size);
  cv::multiply(slope, matched_slope, correlation);
  cv::boxFilter(correlation, correlation, CV_32F, size);
  for (int v = 0; v < slope.rows; ++v) {
    const auto *m = mean.ptr<float>(v), *n = matched_mean.ptr<float>(v);
    const auto *a = square.ptr<float>(v), *b = matched_square.ptr<float>(v);
    auto* c = correlation.ptr<float>(v);
    for (int u = 0; u < slope.cols; ++u) {
      const float variance = a[u] - m[u] * m[u], matched = b[u] - n[u] * n[u];
      const bool any = variance > kRounding && matched > kRounding;
      c[u] = any ? (c[u] - m[u] * n[u]) / std::sqrt(variance * matched) : 0.0F;
    }
  }
}

StereoDepth::StereoDepth(const StereoCamera& camera, const StereoDepthOptions& options)
    : camera_(camera), options_(options), matcher_(std::make_unique<Matcher>()) {
  validate(camera);
  check_positive(kOwner, "nearest", options.nearest);
  check_positive(kOwner, "sigma_disparity", options.sigma_disparity);
  check_parameter(options.most_disparities >= 1 && options.most_disparities <= 1024, kOwner,
                  "most_disparities", options.most_disparities, "1 to 1024");
  check_side("window", options.window);
  check_side("block", options.block);
  const double fb = camera.left.fx * camera.baseline;
  const auto whole_steps = [](double n) { return kStep * std::ceil(n / kStep); };
  Matcher& m = *matcher_;
  m.disparities = static_cast<int>(
      whole_steps(std::min<double>(fb / options.nearest, options.most_disparities)));
  noise_ = options.sigma_disparity / fb;
  range_ = {fb / m.disparities, options.most_error / noise_};
  check_parameter(range_.max > range_.min, kOwner, "most_error", options.most_error,
                  "that of the largest disparity at least");
  const int area = options.window * options.window;
  m.search = cv::StereoSGBM::create(0, m.disparities, options.window, kSmallStep * area,
                                    kLargeStep * area, options.max_inconsistency, kMostSlope,
                                    static_cast<int>(std::lround(100.0 * options.distinctness)),
                                    options.least_surface, 1, cv::StereoSGBM::MODE_SGBM_3WAY);
}

StereoDepth::~StereoDepth() = default;
StereoDepth::StereoDepth(StereoDepth&&) noexcept = default;
StereoDepth& StereoDepth::operator=(StereoDepth&&) noexcept = default;

DepthImage StereoDepth::depth(const ImageView& left, const ImageView& right) {
  const int width = static_cast<int>(camera_.left.width);
  const int height = static_cast<int>(camera_.left.height);
  for (const ImageView* image : {&left, &right}) {
    if (image->empty() || image->width != width || image->height != height) return {};
  }
  Matcher& m = *matcher_;
  m.match(view_of(left), view_of(right));
  m.correlate(view_of(left), view_of(right), options_.block);
  const double fb = camera_.left.fx * camera_.baseline;
  DepthImage out(width, height);
  for (int v = 0; v < height; ++v) {
    const auto* disparity = m.disparity.ptr<std::int16_t>(v) + m.disparities;
    const auto* correlation = m.correlation.ptr<float>(v);
    for (int u = 0; u < width; ++u) {
      const double d = static_cast<double>(disparity[u]) / kSixteenths;
      if (!(d > 0.0) || d > u || correlation[u] < options_.least_correlation) continue;
      const double z = fb / d;
      if (range_.holds(z)) out.at(u, v) = static_cast<float>(z);
    }
  }
  return out;
}

}  // namespace prospect
