// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/feature_density.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/knobs.h"

namespace prospect {

FeatureDensity::FeatureDensity(const FeatureDensityOptions& options)
    : options_(options), value_(options.initial) {
  check_knobs("feature density", options);
}

void FeatureDensity::add(int new_landmarks, double surface) {
  new_landmarks_ += new_landmarks;
  const double grown = surface - last_surface_;
  if (!(grown >= options_.area)) return;
  samples_.push_back(new_landmarks_ / grown);
  if (static_cast<int>(samples_.size()) > options_.window) samples_.pop_front();
  last_surface_ = surface;
  new_landmarks_ = 0;
  if (samples_.size() < 4) return;
  std::vector<double> sorted(samples_.begin(), samples_.end());
  const auto rank =
      static_cast<std::ptrdiff_t>(options_.quantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  value_ = sorted[static_cast<std::size_t>(rank)];
}

}  // namespace prospect
