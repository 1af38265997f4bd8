// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/landmark_map.h"

namespace prospect::test {

/// What can be wrong with a landmark: the entry that a message must name, and how to spoil it.
inline std::vector<std::pair<std::string, std::function<void(Landmark&)>>> landmark_faults() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<std::pair<std::string, std::function<void(Landmark&)>>> faults;
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e7, -1e300}) {
    for (int a = 0; a < 3; ++a) {
      faults.emplace_back("position", [=](Landmark& l) { l.position[a] = bad; });
    }
  }
  for (const double bad : {kNan, kInfinity, 1e13, -1e-3}) {
    faults.emplace_back("covariance", [=](Landmark& l) { l.covariance(0, 0) = bad; });
    faults.emplace_back("covariance", [=](Landmark& l) { l.covariance(2, 2) = bad; });
  }
  faults.emplace_back("covariance", [=](Landmark& l) { l.covariance(0, 1) = kNan; });
  faults.emplace_back("covariance",
                      [](Landmark& l) { l.covariance(0, 1) = l.covariance(1, 0) = 2e-4; });
  faults.emplace_back("covariance", [](Landmark& l) { l.covariance *= -1.0; });
  faults.emplace_back("covariance", [](Landmark& l) { l.covariance *= 1e17; });
  for (const double bad : {0.0, kNan, 2.0, 0.5, kInfinity}) {
    faults.emplace_back("creation_direction", [=](Landmark& l) { l.creation_direction *= bad; });
  }
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    faults.emplace_back("creation_range", [=](Landmark& l) { l.creation_range = bad; });
  }
  for (const double bad : {-0.1, 1.0001, kNan, kInfinity}) {
    faults.emplace_back("survival", [=](Landmark& l) { l.survival = bad; });
  }
  for (const double bad : {0.0, -1.0, 2e6, kNan, kInfinity}) {
    faults.emplace_back("multiplicity", [=](Landmark& l) { l.multiplicity = bad; });
  }
  for (const double bad : {-0.5, 1e7, kNan, kInfinity}) {
    faults.emplace_back("per_cell", [=](Landmark& l) { l.per_cell = bad; });
  }
  return faults;
}

}  // namespace prospect::test
