#include "perception/odometry/corner_detector.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

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
  cv::Mat strength;
  cv::cornerMinEigenVal(grey, strength, kBlock, 3);
  // OpenCV's gradients of 8-bit images are 2/255 times grey levels a pixel (Sobel gain 8, divided
  // by 4 and 255), and its block is a sum divided by its size.
  const float floor = static_cast<float>(options.min_strength * 4.0 / (255.0 * 255.0));

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
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (full[row * columns + column]) continue;
      const int u0 = std::max(border, static_cast<int>(std::ceil(column * cell)));
      const int v0 = std::max(border, static_cast<int>(std::ceil(row * cell)));
      const int u1 =
          std::min(image.width - border, static_cast<int>(std::ceil((column + 1) * cell)));
      const int v1 = std::min(image.height - border, static_cast<int>(std::ceil((row + 1) * cell)));
      candidates.clear();
      for (int v = v0; v < v1; ++v) {
        const float* above = strength.ptr<float>(v - 1);
        const float* here = strength.ptr<float>(v);
        const float* below = strength.ptr<float>(v + 1);
        for (int u = u0; u < u1; ++u) {
          const float s = here[u];
          if (!(s >= floor)) continue;
          if (s < here[u - 1] || s < here[u + 1] || s < above[u] || s < below[u]) continue;
          if (s < above[u - 1] || s < above[u + 1] || s < below[u - 1] || s < below[u + 1])
            continue;
          candidates.push_back({s, u, v});
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
