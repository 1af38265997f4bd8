// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include "perception/odometry/corner_detector.h"
#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/median.h"
#include "perception/odometry/stereo_matcher.h"

namespace prospect {
namespace {

/// The image with its rows moved up by `shift`; both are cut to the rows that are left.
ImageView cut(const ImageView& image, int from, int rows) {
  return {image.data + from * image.stride, image.width, rows, image.stride};
}

}  // namespace

StereoCheck check_stereo(const ImageView& left, const ImageView& right, int max_shift) {
  if (left.empty() || right.empty() || left.width != right.width || left.height != right.height) {
    throw std::invalid_argument("stereo check: expected two images of the same size");
  }
  const auto count = [](const ImageView& a, const ImageView& b, StereoCheck* out) {
    const auto corners = detect_corners(a);
    const auto matches = match_stereo(ImagePyramid(a, 1), ImagePyramid(b, 1), corners);
    if (out) {
      out->corners = static_cast<int>(corners.size());
      std::vector<double> rows;
      for (const StereoMatch& m : matches) rows.push_back(m.row_error);
      if (!rows.empty()) out->row_error = median(rows);
    }
    return static_cast<int>(matches.size());
  };
  StereoCheck check;
  check.matches = count(left, right, &check);
  check.matches_swapped = count(right, left, nullptr);
  check.matches_shifted = check.matches;
  // A pair that matches well needs no search.
  if (2 * check.matches >= check.corners) return check;
  const int limit = std::min(max_shift, left.height / 4);
  for (int shift = -limit; shift <= limit; ++shift) {
    if (shift == 0) continue;
    const int rows = left.height - std::abs(shift);
    const int n =
        count(cut(left, std::max(0, -shift), rows), cut(right, std::max(0, shift), rows), nullptr);
    if (n > check.matches_shifted) {
      check.matches_shifted = n;
      check.row_shift = shift;
    }
  }
  return check;
}

std::string stereo_complaint(const StereoCheck& check) {
  char text[200];
  const int most = std::max({check.matches, check.matches_swapped, check.matches_shifted});
  if (most < 20) return {};
  if (check.matches_swapped > 3 * check.matches && check.matches_swapped >= check.matches_shifted) {
    std::snprintf(text, sizeof text,
                  "left and right look exchanged: %d matches as they are, %d the other way round",
                  check.matches, check.matches_swapped);
    return text;
  }
  if (std::abs(check.row_shift) >= 1 && check.matches_shifted > 1.5 * check.matches) {
    std::snprintf(text, sizeof text,
                  "rows do not correspond: the right image fits %d px %s (%d matches instead of "
                  "%d); expected a rectified pair",
                  std::abs(check.row_shift), check.row_shift > 0 ? "higher" : "lower",
                  check.matches_shifted, check.matches);
    return text;
  }
  if (std::abs(check.row_error) > 0.75) {
    std::snprintf(text, sizeof text,
                  "rows are off by %.2f px; expected a rectified pair, 0.75 px at most",
                  check.row_error);
    return text;
  }
  return {};
}

}  // namespace prospect
