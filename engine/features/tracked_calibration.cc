// SPDX-License-Identifier: Apache-2.0
#include "engine/features/tracked_calibration.h"

#include <algorithm>

namespace prospect {

void calibrate_to_tracked(std::vector<Landmark>& landmarks, const Eigen::VectorXd& visible,
                          double tracked) {
  constexpr double kLeast = 0.25, kMost = 4.0;
  double predicted = 0.0, slope = 0.0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const double pi = visible[static_cast<Eigen::Index>(i)];
    predicted += landmarks[i].multiplicity * pi;
    slope += landmarks[i].multiplicity * pi * pi / std::max(landmarks[i].survival, 1e-3);
  }
  if (!(slope > 1e-9)) return;
  const double c = std::clamp(1.0 + (tracked - predicted) / slope, kLeast, kMost);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const double pi = visible[static_cast<Eigen::Index>(i)];
    const double factor = 1.0 + (c - 1.0) * pi / std::max(landmarks[i].survival, 1e-3);
    landmarks[i].multiplicity = std::min(kMostMultiplicity, landmarks[i].multiplicity * factor);
  }
}

}  // namespace prospect
