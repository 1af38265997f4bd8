// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "models/image.h"
#include "perception/odometry/stereo_odometry.h"

namespace prospect::test {

/// What reaches the odometry as one frame.
struct StereoFrame {
  double stamp = 0.0;
  Image left, right;
};

/// A fault of cameras or driver, injected into frames [first, first + count) of a sequence.
struct ImageFault {
  std::string name;
  int count = 4;
  /// The frame as it arrives, from the true one, the one before, and how many faulty frames there
  /// were before.
  std::function<StereoFrame(const StereoFrame& now, const StereoFrame& before_fault, int k)> apply;
  bool must_be_lost = false;  ///< lost, not only degraded
};

inline Image box_blur(const Image& image, int radius) {
  // Twice a running mean along rows, as fast motion does.
  Image out = image;
  for (int pass = 0; pass < 2; ++pass) {
    const Image from = out;
    for (int v = 0; v < image.height; ++v) {
      int sum = 0;
      for (int u = -radius; u < image.width; ++u) {
        if (u + radius < image.width) sum += from.at(u + radius, v);
        if (u - radius - 1 >= 0) sum -= from.at(u - radius - 1, v);
        const int n = std::min(u + radius, image.width - 1) - std::max(u - radius, 0) + 1;
        if (u >= 0) out.at(u, v) = static_cast<std::uint8_t>(sum / n);
      }
    }
  }
  return out;
}

inline Image half_black(const Image& image, bool left_half) {
  Image out = image;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      if ((u < image.width / 2) == left_half) out.at(u, v) = 0;
    }
  }
  return out;
}

inline Image noise_image(int width, int height, std::uint32_t seed) {
  Image out(width, height);
  for (auto& p : out.pixels) {
    seed = seed * 1664525u + 1013904223u;
    p = static_cast<std::uint8_t>(seed >> 24);
  }
  return out;
}

inline std::vector<ImageFault> image_faults() {
  using F = const StereoFrame&;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {
      {"blank (both)", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, Image(now.left.width, now.left.height, 90),
                            Image(now.left.width, now.left.height, 90)};
       },
       true},
      {"blank (right)", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, now.left, Image(now.left.width, now.left.height, 90)};
       },
       true},
      {"strong blur", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, box_blur(now.left, 12), box_blur(now.right, 12)};
       }},
      {"frozen (both)", 6,
       [](F now, F before, int) {
         return StereoFrame{now.stamp, before.left, before.right};
       }},
      {"frozen (right)", 6,
       [](F now, F before, int) {
         return StereoFrame{now.stamp, now.left, before.right};
       }},
      {"swapped", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, now.right, now.left};
       },
       true},
      {"half black (both)", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, half_black(now.left, true), half_black(now.right, true)};
       }},
      {"half black (right)", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, now.left, half_black(now.right, false)};
       }},
      {"noise only", 4,
       [](F now, F, int k) {
         return StereoFrame{now.stamp, noise_image(now.left.width, now.left.height, 7 + 2 * k),
                            noise_image(now.left.width, now.left.height, 8 + 2 * k)};
       },
       true},
      {"wrong size", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, Image(now.left.width / 2, now.left.height / 2, 90),
                            now.right};
       },
       true},
      {"empty", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp, Image(), Image()};
       },
       true},
      {"time NaN", 4,
       [nan](F now, F, int) {
         return StereoFrame{nan, now.left, now.right};
       },
       true},
      {"time goes back", 4,
       [](F now, F, int) {
         return StereoFrame{now.stamp - 100.0, now.left, now.right};
       },
       true},
      {"dropped frames", 3, nullptr},  // the frames never arrive
  };
}

/// What the odometry says of a fault in frames [first, first + count), frame by frame.
class FaultOutcome {
 public:
  FaultOutcome(const ImageFault& fault, int first) : fault_(fault), first_(first) {}

  /// Whether frame k is one of the faulty.
  bool faulty(int k) const { return k >= first_ && k < first_ + fault_.count; }

  void add(int k, const OdometryFrame& out) {
    const int after = first_ + fault_.count;
    // Of frames that never arrive the next one tells.
    if (faulty(k) || (!fault_.apply && k == after)) {
      if (out.state != Localization::kOk && noticed_ < 0) {
        noticed_ = faulty(k) ? k - first_ : 0;
        reason_ = out.reason;
      }
      worst_ = std::max(worst_, out.state);
    } else if (k >= after && good_again_ < 0 && out.state == Localization::kOk) {
      good_again_ = k - after;
    }
  }

  /// Noticed within two frames, lost where it must be, and good again at most so many frames after
  /// the fault. Prints the row of a table.
  void expect(int recovery) const {
    std::printf("%-20s %-9s %-48s ok again after %d\n", fault_.name.c_str(),
                to_string(worst_).data(), reason_.c_str(), good_again_);
    EXPECT_GE(noticed_, 0);
    EXPECT_LE(noticed_, 1);
    if (fault_.must_be_lost) {
      EXPECT_EQ(worst_, Localization::kLost);
    }
    EXPECT_GE(good_again_, 0);
    EXPECT_LE(good_again_, recovery);
  }

 private:
  const ImageFault& fault_;
  int first_;
  Localization worst_ = Localization::kOk;
  std::string reason_;
  int noticed_ = -1, good_again_ = -1;
};

}  // namespace prospect::test
