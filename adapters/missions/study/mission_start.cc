// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/mission_start.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace prospect {

Pose mission_start(const Pose& own, const Grid<std::uint8_t>& standing, std::uint64_t seed) {
  if (seed == 1) return own;
  std::vector<Cell> places;
  for (int i = 0; i < standing.frame.size(); ++i) {
    const Cell cell = standing.frame.at(i);
    if (standing[cell] != 0) places.push_back(cell);
  }
  if (places.empty()) throw std::invalid_argument("mission_start: no place to stand");
  // Not a distribution of the standard library: theirs differ between implementations.
  std::mt19937_64 draw(seed);
  const Eigen::Vector2d center = standing.frame.center(places[draw() % places.size()]);
  const double share = static_cast<double>(draw() >> 11) * 0x1p-53;  // [0, 1)
  return {{center.x(), center.y(), own.position.z()}, (2.0 * share - 1.0) * M_PI};
}

}  // namespace prospect
