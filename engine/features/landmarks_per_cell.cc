// SPDX-License-Identifier: Apache-2.0
#include "engine/features/landmarks_per_cell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace prospect {

void note_landmarks_per_cell(LandmarkMap& map) {
  constexpr double kRadius = 0.5;  // h [m]
  std::vector<Landmark*> along_x;
  for (Landmark& l : map.landmarks) {
    l.per_cell = 0.0;
    if (l.position.allFinite() && l.creation_direction.allFinite() && l.multiplicity > 0.0 &&
        std::isfinite(l.multiplicity) && l.survival >= 0.0 && std::isfinite(l.survival)) {
      along_x.push_back(&l);
    }
  }
  if (!(map.image_cell > 0.0) || !std::isfinite(map.image_cell)) return;
  std::sort(along_x.begin(), along_x.end(),
            [](const Landmark* a, const Landmark* b) { return a->position.x() < b->position.x(); });
  for (std::size_t i = 0; i < along_x.size(); ++i) {
    Landmark& a = *along_x[i];
    a.per_cell += std::max(0.0, a.multiplicity - 1.0) * a.survival;
    for (std::size_t j = i + 1; j < along_x.size(); ++j) {
      Landmark& b = *along_x[j];
      if (!(b.position.x() - a.position.x() < kRadius)) break;
      if (!((b.position - a.position).squaredNorm() < kRadius * kRadius)) continue;
      if (!(a.creation_direction.dot(b.creation_direction) > 0.0)) continue;
      a.per_cell += b.multiplicity * b.survival;
      b.per_cell += a.multiplicity * a.survival;
    }
  }
  const double cell = map.image_cell * map.image_cell / (std::numbers::pi * kRadius * kRadius);
  for (Landmark* l : along_x) l->per_cell *= cell;
}

}  // namespace prospect
