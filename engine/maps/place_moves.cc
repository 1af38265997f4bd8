// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/place_moves.h"

#include <limits>

namespace prospect {
namespace {

template <typename Place>
PlaceMoves::Known nearest(const std::vector<PlaceMoves::Known>& known, const Eigen::Vector2d& p,
                          const Place& place) {
  const PlaceMoves::Known* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const PlaceMoves::Known& k : known) {
    const double d = (place(k) - p).squaredNorm();
    if (d > least) continue;  // of equals the newest
    least = d;
    best = &k;
  }
  return best != nullptr ? *best : PlaceMoves::Known();
}

Eigen::Vector2d place_now(const PlaceMoves::Known& k) { return k.move(k.before); }

}  // namespace

PlanarMove PlaceMoves::of_before(const Eigen::Vector2d& p) const {
  return nearest(known_, p, [](const Known& k) { return k.before; }).move;
}

PlanarMove PlaceMoves::of_now(const Eigen::Vector2d& p) const {
  return nearest(known_, p, place_now).move;
}

double PlaceMoves::variance(const Eigen::Vector2d& p) const {
  return nearest(known_, p, place_now).variance;
}

}  // namespace prospect
