// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/known_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prospect {
namespace {

/// The march ends nowhere but where all is reached.
constexpr Cell kNowhere{std::numeric_limits<int>::min() / 4, std::numeric_limits<int>::min() / 4};

CostToGoOptions plain() {
  CostToGoOptions options;
  options.lambda = 0.0;
  return options;
}

}  // namespace

KnownPaths::KnownPaths(const GroundMap& ground, const Pose& pose,
                       const TraversabilityOptions& options, const Eigen::Vector2d& place,
                       const PausePoint& pause)
    : traversability_(options), field_(plain()) {
  traversability_.update(ground, &pose, pause);
  const GridFrame& frame = traversability_.frame();
  const bool stands = traversability_.passable(frame.cell(place.x(), place.y()));
  const double radius = stands ? 0.75 * frame.resolution : kNear;
  field_.solve_from_scratch(traversability_, GoalSources(frame, place, radius, 1.0), kNowhere,
                            pause);
}

double KnownPaths::length_near(const Eigen::Vector2d& p) const {
  const GridFrame& frame = traversability_.frame();
  const Cell at = frame.cell(p.x(), p.y());
  const int reach = static_cast<int>(std::ceil(kNear / frame.resolution));
  double least = std::numeric_limits<double>::infinity();
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const double distance = frame.resolution * std::hypot(di, dj);
      if (distance > kNear) continue;
      least = std::min(least, distance + length({at.i + di, at.j + dj}));
    }
  }
  return least;
}

std::vector<Cell> KnownPaths::path(Cell c) const {
  std::vector<Cell> cells{c};
  while (true) {
    const Cell next = field_.downhill(cells.back());
    if (next == cells.back()) return cells;
    cells.push_back(next);
  }
}

}  // namespace prospect
