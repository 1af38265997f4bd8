// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "models/image.h"

namespace prospect {

/// The exposure of a camera that follows the light with a lag: after an image of mean grey m, dt
/// after the one before,
///   log e += (1 - exp(-dt / lag)) log(120 / m),   1/16 <= e <= 16.
/// With a lag of 0 it stays 1. Thread-safety: one thread.
class ExposureControl {
 public:
  static constexpr double kWanted = 120.0;  ///< [grey levels]

  explicit ExposureControl(double lag) : lag_(lag) {}

  double exposure() const { return exposure_; }  ///< of the next image

  void measured(double stamp, const Image& image) {
    if (lag_ <= 0.0 || image.pixels.empty()) return;
    const double dt = std::max(0.0, stamp - stamp_);
    stamp_ = stamp;
    const double sum = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
    const double mean = std::max(1.0, sum / static_cast<double>(image.pixels.size()));
    exposure_ *= std::pow(kWanted / mean, 1.0 - std::exp(-dt / lag_));
    exposure_ = std::clamp(exposure_, 1.0 / kMost, kMost);
  }

 private:
  static constexpr double kMost = 16.0;
  double lag_, stamp_ = 0.0, exposure_ = 1.0;
};

}  // namespace prospect
