// SPDX-License-Identifier: Apache-2.0
#include "perception/places/stereo_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <stdexcept>
#include <vector>

#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/patch_alignment.h"

namespace prospect {
namespace {

constexpr int kR = 5;                    // of the patches that are looked for along a row
constexpr float kLeastTexture = 0.5F;    // Patch::make()
constexpr float kLeastAgreement = 0.6F;  // Patch::Alignment

cv::Mat as_mat(const ImageView& image) {
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                 static_cast<std::size_t>(image.stride));
}

/// Sums of absolute differences of a patch of one image with those of another's same row, by the
/// column of their middle.
class RowDifferences {
 public:
  /// Columns first to last of `to`; all patches lie inside.
  void compute(const ImageView& from, int u, int v, const ImageView& to, int first, int last) {
    sums_.assign(static_cast<std::size_t>(last - first + 1), 0);
    constexpr int kSide = 2 * kR + 1;
    for (int y = -kR; y <= kR; ++y) {
      const std::uint8_t* patch = from.row(v + y) + u - kR;
      const std::uint8_t* row = to.row(v + y) + first - kR;
      for (int x = 0; x < kSide; ++x) {
        const int grey = patch[x];
        const int n = last - first + 1;
        for (int i = 0; i < n; ++i) {
          const int d = grey - row[i + x];
          sums_[static_cast<std::size_t>(i)] =
              static_cast<std::uint16_t>(sums_[static_cast<std::size_t>(i)] + (d < 0 ? -d : d));
        }
      }
    }
    first_ = first;
  }
  int best() const {
    return first_ + static_cast<int>(std::min_element(sums_.begin(), sums_.end()) - sums_.begin());
  }
  /// Whether all that is more than two columns away differs by this factor more.
  bool is_distinct(int column, double factor) const {
    const int at = column - first_;
    const double least = factor * sums_[static_cast<std::size_t>(at)];
    for (int i = 0; i < static_cast<int>(sums_.size()); ++i) {
      if (std::abs(i - at) > 2 && sums_[static_cast<std::size_t>(i)] < least) return false;
    }
    return true;
  }

 private:
  int first_ = 0;
  std::vector<std::uint16_t> sums_;
};

/// Disparities of a view's corners. A patch is looked for along its row, must be found distinctly,
/// and from there find its way back; then it is aligned (patch_alignment.h). That is a fourth of
/// the work of match_stereo(), which sees slopes as well and turns its patches back.
class Disparities {
 public:
  Disparities(const ImageView& left, const ImageView& right, const StereoViewOptions& options)
      : left_(left), right_(right), options_(options), L_(left, 1), R_(right, 1) {}

  void measure(StereoView::Point& point) {
    const int u = static_cast<int>(std::lround(point.pixel.x()));
    const int v = static_cast<int>(std::lround(point.pixel.y()));
    if (v < kR || v >= left_.height - kR || u < kR || u >= left_.width - kR) return;
    const int reach = static_cast<int>(options_.max_disparity * left_.width);
    there_.compute(left_, u, v, right_, std::max(kR, u - reach), u);
    const int x = there_.best();
    if (!there_.is_distinct(x, options_.distinctness)) return;
    back_.compute(right_, x, v, left_, x, std::min(x + reach, left_.width - 1 - kR));
    if (std::abs(back_.best() - u) > 1) return;
    const Eigen::Vector2f centre = point.pixel.cast<float>();
    const auto patch = Patch::make(L_.level(0), centre, Eigen::Matrix2f::Identity(), kLeastTexture);
    if (!patch) return;
    const Eigen::Vector2f start(static_cast<float>(x) + centre.x() - static_cast<float>(u),
                                centre.y());
    const Patch::Alignment found = patch->align(R_.level(0), start, 2.5F);
    const double disparity = static_cast<double>(centre.x()) - found.position.x();
    if (!found.converged || found.agreement < kLeastAgreement || disparity < 1.0 ||
        std::abs(found.position.y() - centre.y()) > options_.max_row_error) {
      return;
    }
    point.disparity = disparity;
    point.sigma_disparity =
        std::sqrt(options_.texture_noise * static_cast<double>(found.covariance(0, 0)));
  }

 private:
  ImageView left_, right_;
  StereoViewOptions options_;
  ImagePyramid L_, R_;
  RowDifferences there_, back_;
};

}  // namespace

// Counting bits is one instruction where there is one, and thirty where it must not be assumed.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
__attribute__((target_clones("popcnt", "default")))
#endif
void distances(const ViewDescriptor& of, const StereoView& to, std::int16_t* bits) {
  for (std::size_t j = 0; j < to.points.size(); ++j) {
    const ViewDescriptor& other = to.points[j].descriptor;
    int sum = 0;
    for (std::size_t word = 0; word < of.size(); ++word) {
      sum += __builtin_popcountll(of[word] ^ other[word]);
    }
    bits[j] = static_cast<std::int16_t>(sum);
  }
}

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
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(options.corners, static_cast<float>(options.factor), options.levels, 19, 0, 2,
                      cv::ORB::HARRIS_SCORE, 31, options.least_contrast);
  std::vector<cv::KeyPoint> corners;
  cv::Mat descriptors;
  orb->detectAndCompute(as_mat(left), cv::noArray(), corners, descriptors);

  StereoView view;
  if (corners.empty()) return view;
  Disparities disparities(left, right, options);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    StereoView::Point point;
    point.pixel = {corners[i].pt.x, corners[i].pt.y};
    point.scale = std::pow(options.factor, corners[i].octave);
    std::memcpy(point.descriptor.data(), descriptors.ptr(static_cast<int>(i)),
                sizeof point.descriptor);
    disparities.measure(point);
    view.points.push_back(point);
  }
  return view;
}

}  // namespace prospect
