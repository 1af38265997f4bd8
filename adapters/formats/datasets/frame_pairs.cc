// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/frame_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "adapters/formats/datasets/number_text.h"
#include "perception/odometry/median.h"

namespace prospect {
namespace {

std::size_t nearest_stamp(const std::vector<double>& stamps, double stamp) {
  auto next = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (next == stamps.end() || (next != stamps.begin() && stamp - *(next - 1) <= *next - stamp)) {
    --next;
  }
  return static_cast<std::size_t>(next - stamps.begin());
}

std::string time_text(double seconds) {
  const double size = std::abs(seconds);
  if (size < 1e-3) return number_text(std::round(seconds * 1e6)) + " us";
  if (size < 1.0) return number_text(std::round(seconds * 1e6) / 1e3) + " ms";
  return number_text(seconds) + " s";
}

}  // namespace

FramePairs pair_frames(const ImageStream& left, const ImageStream& right,
                       const std::optional<double>& tolerance) {
  FramePairs out;
  const double steps[2] = {median_step(left.stamps), median_step(right.stamps)};
  double period = std::fmin(steps[0], steps[1]);  // NaN only if both are
  out.tolerance = tolerance ? *tolerance : std::isfinite(period) ? 0.1 * period : 0.005;
  const double ratio = steps[1] / steps[0];
  if (std::isfinite(ratio) && ratio > 0.0) {
    out.left_rate = std::max(1, static_cast<int>(std::lround(ratio)));
    out.right_rate = std::max(1, static_cast<int>(std::lround(1.0 / ratio)));
  }
  if (left.size() == 0 || right.size() == 0) return out;
  std::vector<double> offsets, nearest;
  std::vector<char> left_used(left.size(), 0), right_used(right.size(), 0);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::size_t j = nearest_stamp(right.stamps, left.stamps[i]);
    if (nearest_stamp(left.stamps, right.stamps[j]) != i) continue;
    const double offset = right.stamps[j] - left.stamps[i];
    nearest.push_back(offset);
    if (std::abs(offset) > out.tolerance) continue;
    out.pairs.emplace_back(i, j);
    left_used[i] = right_used[j] = 1;
    offsets.push_back(offset);
    if (std::abs(offset) > std::abs(out.largest_offset)) out.largest_offset = offset;
  }
  if (!nearest.empty()) out.nearest_offset = median(nearest);
  if (!offsets.empty()) out.offset = median(offsets);
  const double begin = std::max(left.stamps.front(), right.stamps.front()) - out.tolerance;
  const double end = std::min(left.stamps.back(), right.stamps.back()) + out.tolerance;
  int inside[2] = {0, 0};
  double first_hole = std::numeric_limits<double>::infinity();
  const auto look = [&](const ImageStream& camera, const std::vector<char>& used, int& alone,
                        int& within, bool counts) {
    for (std::size_t i = 0; i < camera.size(); ++i) {
      if (used[i]) continue;
      ++alone;
      if (camera.stamps[i] < begin || camera.stamps[i] > end) continue;
      ++within;
      if (counts && camera.stamps[i] < first_hole) {
        first_hole = camera.stamps[i];
        out.first_hole = camera.names[i];
      }
    }
  };
  look(left, left_used, out.left_alone, inside[0], out.left_rate == 1);
  look(right, right_used, out.right_alone, inside[1], out.right_rate == 1);
  // Between two pairs a camera that is k times as fast has k - 1 images of its own.
  const int pairs = static_cast<int>(out.pairs.size());
  out.holes = std::max(0, inside[0] - (out.left_rate - 1) * (pairs + inside[1])) +
              std::max(0, inside[1] - (out.right_rate - 1) * (pairs + inside[0]));
  return out;
}

std::string pairing_problem(const FramePairs& pairs, const ImageStream& left,
                            const ImageStream& right) {
  const int n = static_cast<int>(pairs.pairs.size());
  if (n > 0 && 5 * pairs.holes <= n + pairs.holes) return {};
  if (n == 0) {
    if (left.size() == 0 || right.size() == 0) {
      return (left.size() == 0 ? left : right).name +
             ": holds no image; expected those of a camera";
    }
    if (left.stamps.back() < right.stamps.front() || right.stamps.back() < left.stamps.front()) {
      return right.name + ": its stamps, " + number_text(right.stamps.front()) + " to " +
             number_text(right.stamps.back()) + " s, and those of " + left.name + ", " +
             number_text(left.stamps.front()) + " to " + number_text(left.stamps.back()) +
             " s, share no time; expected images taken together";
    }
    return right.name + ": no image within " + time_text(pairs.tolerance) + " of one of " +
           left.name + "; the right stamps are " + time_text(pairs.nearest_offset) +
           " later in the median; expected images taken together, or --sync SECONDS to take these "
           "for pairs";
  }
  if (!pairs.first_hole.empty()) {
    return pairs.first_hole + ": the other camera has no such image, and " +
           std::to_string(std::max(0, pairs.holes - 1)) +
           " more are alone; expected the same names or stamps within " +
           time_text(pairs.tolerance) + " for both cameras, or --sync SECONDS";
  }
  return right.name + ": " + std::to_string(pairs.holes) +
         " images are alone; expected stamps within " + time_text(pairs.tolerance) +
         " of the other camera's, or --sync SECONDS";
}

std::vector<std::string> pairing_notes(const FramePairs& pairs, const ImageStream& left,
                                       const ImageStream& right) {
  std::vector<std::string> notes;
  const int alone = pairs.left_alone + pairs.right_alone;
  const auto rate = [](const ImageStream& camera) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g Hz", 1.0 / median_step(camera.stamps));
    return std::string(text);
  };
  if (pairs.left_rate != pairs.right_rate) {
    notes.push_back("left at " + rate(left) + ", right at " + rate(right) + ": the " +
                    std::to_string(pairs.pairs.size()) + " pairs are used, " +
                    std::to_string(alone) + " frames of one camera only left out");
  } else if (alone > 0) {
    notes.push_back(std::to_string(alone) + " frames of one camera only left out");
  }
  if (pairs.largest_offset != 0.0) {
    std::string note = "right stamps " + time_text(std::abs(pairs.offset)) +
                       (pairs.offset < 0.0 ? " before" : " after") +
                       " the left ones in the median, at most " +
                       time_text(std::abs(pairs.largest_offset)) + ": paired";
    // At 1 rad/s and f = 500 px, 2 ms are a pixel of disparity.
    if (std::abs(pairs.offset) > 0.002) {
      note += "; if the images were taken so, depths are wrong while the camera turns";
    }
    notes.push_back(note);
  }
  return notes;
}

}  // namespace prospect
