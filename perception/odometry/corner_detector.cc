// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/corner_detector.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "perception/odometry/image_noise.h"

namespace prospect {
namespace {

constexpr int kBlock = 7;

struct Candidate {
  float strength;
  int u, v;
};

}  // namespace

double corner_cell(int width, int height, const CornerDetectorOptions& options) {
  return std::sqrt(static_cast<double>(width) * height / std::max(1, options.cells));
}

std::vector<Eigen::Vector2f> detect_corners(const ImageView& image,
                                            const std::vector<Eigen::Vector2f>& occupied,
                                            const CornerDetectorOptions& options) {
  if (image.empty()) throw std::invalid_argument("corner detector: the image is empty");
  const cv::Mat grey(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  // OpenCV's gradients of 8-bit images are 2/255 times grey levels a pixel (Sobel gain 8, divided
  // by 4 and 255), and its block is a sum divided by its size.
  const double noise = image_noise(image);
  const float floor =
      static_cast<float>(options.min_strength_over_noise * noise * noise * 4.0 / (255.0 * 255.0));

  const double cell = std::max(2.0, corner_cell(image.width, image.height, options));
  const int columns = std::max(1, static_cast<int>(std::ceil(image.width / cell)));
  const int rows = std::max(1, static_cast<int>(std::ceil(image.height / cell)));
  // Points by cell, for the distance test.
  std::vector<std::vector<Eigen::Vector2f>> taken(static_cast<std::size_t>(columns) * rows);
  std::vector<char> full(taken.size(), 0);
  const auto cell_of = [&](float u, float v) {
    const int c = std::clamp(static_cast<int>(u / cell), 0, columns - 1);
    const int r = std::clamp(static_cast<int>(v / cell), 0, rows - 1);
    return r * columns + c;
  };
  for (const Eigen::Vector2f& p : occupied) {
    if (!p.allFinite()) continue;
    taken[cell_of(p.x(), p.y())].push_back(p);
    full[cell_of(p.x(), p.y())] = 1;
  }
  const float distance2 = static_cast<float>(0.25 * cell * cell);
  const auto near_other = [&](int column, int row, float u, float v) {
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c) {
        for (const Eigen::Vector2f& p : taken[r * columns + c]) {
          if ((p - Eigen::Vector2f(u, v)).squaredNorm() < distance2) return true;
        }
      }
    }
    return false;
  };

  std::vector<Eigen::Vector2f> corners;
  std::vector<Candidate> candidates;
  const int border = std::max(1, options.border);
  const auto first_pixel = [&](int n) { return static_cast<int>(std::ceil(n * cell)); };
  for (int row = 0; row < rows; ++row) {
    const int v0 = std::max(border, first_pixel(row));
    const int v1 = std::min(image.height - border, first_pixel(row + 1));
    if (v0 >= v1) continue;
    int strong_until = 0;  // the column of cells up to which the row's strength is known
    cv::Mat strength;
    cv::Rect part;
    for (int column = 0; column < columns; ++column) {
      if (full[row * columns + column]) continue;
      if (column >= strong_until) {
        strong_until = column + 1;
        while (strong_until < columns && !full[row * columns + strong_until]) ++strong_until;
        // Local maxima look one pixel farther, and blocks half their side.
        constexpr int kMargin = 1 + kBlock / 2;
        const int u0 = first_pixel(column), u1 = first_pixel(strong_until);
        part = cv::Rect(u0 - kMargin, v0 - kMargin, u1 - u0 + 2 * kMargin, v1 - v0 + 2 * kMargin) &
               cv::Rect(0, 0, image.width, image.height);
        cv::cornerMinEigenVal(grey(part), strength, kBlock, 3);
      }
      const int u0 = std::max(border, first_pixel(column));
      const int u1 = std::min(image.width - border, first_pixel(column + 1));
      candidates.clear();
      for (int v = v0; v < v1; ++v) {
        const float* above = strength.ptr<float>(v - 1 - part.y);
        const float* here = strength.ptr<float>(v - part.y);
        const float* below = strength.ptr<float>(v + 1 - part.y);
        for (int x = u0 - part.x; x < u1 - part.x; ++x) {
          const float s = here[x];
          if (!(s >= floor)) continue;
          if (s < here[x - 1] || s < here[x + 1] || s < above[x] || s < below[x]) continue;
          if (s < above[x - 1] || s < above[x + 1] || s < below[x - 1] || s < below[x + 1])
            continue;
          candidates.push_back({s, x + part.x, v});
        }
      }
      std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        if (a.strength != b.strength) return a.strength > b.strength;
        return a.v != b.v ? a.v < b.v : a.u < b.u;
      });
      for (const Candidate& c : candidates) {
        const float u = static_cast<float>(c.u), v = static_cast<float>(c.v);
        if (near_other(column, row, u, v)) continue;
        corners.emplace_back(u, v);
        taken[row * columns + column].emplace_back(u, v);
        break;
      }
    }
  }
  return corners;
}

}  // namespace prospect
