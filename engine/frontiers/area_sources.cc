// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/area_sources.h"

#include <algorithm>
#include <limits>

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Eigen::Vector2d;

Polygon within(Polygon area, const Eigen::AlignedBox2d& box) {
  for (const int axis : {0, 1}) {
    const Vector2d along = Vector2d::Unit(axis);
    if (!area.empty()) area = clipped(area, along, box.min()[axis]);
    if (!area.empty()) area = clipped(area, -along, -box.max()[axis]);
  }
  return area;
}

}  // namespace

AreaSources::AreaSources(const Traversability& traversability, const Polygon& area,
                         const PausePoint& pause)
    : frame_(traversability.frame()), beyond_(traversability.options().unknown_travel) {
  const TraversabilityOptions& options = traversability.options();
  wanted_ = Grid<std::uint8_t>(frame_, 0, pause);
  const Polygon told = options.extent ? within(area, *options.extent) : area;
  beyond_extent_ = told.empty();
  if (told.empty()) return;

  const double r = frame_.resolution;
  const Vector2d first = r * Vector2d(frame_.i0 + 1, frame_.j0 + 1);
  const Vector2d last = r * Vector2d(frame_.i0 + frame_.width - 1, frame_.j0 + frame_.height - 1);
  for (const int axis : {0, 1}) {
    const Vector2d along = Vector2d::Unit(axis);
    for (Polygon part : {clipped(told, -along, -first[axis]), clipped(told, along, last[axis])}) {
      if (!part.empty()) outside_.push_back(std::move(part));
    }
  }

  Vector2d low = told.front(), high = told.front();
  for (const Vector2d& p : told) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low = low.cwiseMax(first);
  high = high.cwiseMin(last);
  if ((low.array() > high.array()).any()) return;
  const Cell from = frame_.cell(low.x(), low.y()), to = frame_.cell(high.x(), high.y());
  std::vector<Cell> unknown;  // in scan order
  for (int j = from.j; j <= to.j; ++j) {
    pause();
    for (int i = from.i; i <= to.i; ++i) {
      const Cell c{i, j};
      if (!frame_.contains(c)) continue;
      const Vector2d center = frame_.center(c);
      if (!contains(told, center)) continue;
      if (options.zones != nullptr && options.zones->distance(center) <= 0.0) continue;
      ++counted_;
      const CellState state = traversability.state(c);
      if (state == CellState::kFree) seen_ += r * r;
      if (state != CellState::kUnknown || !traversability.passable(c)) continue;
      wanted_[c] = 1;
      unknown.push_back(c);
    }
  }

  // Parts that are too small are unknown for want of an observation that shows them.
  Grid<std::uint8_t> reached(frame_, 0, pause);
  std::vector<Cell> part;
  for (const Cell seed : unknown) {
    if (reached[seed] != 0) continue;
    part.assign(1, seed);
    reached[seed] = 1;
    for (std::size_t n = 0; n < part.size(); ++n) {
      if (n % 1024 == 0) pause();
      const Cell c = part[n];
      for (const Cell next :
           {Cell{c.i + 1, c.j}, Cell{c.i - 1, c.j}, Cell{c.i, c.j + 1}, Cell{c.i, c.j - 1}}) {
        if (wanted_.get(next, 0) == 0 || reached[next] != 0) continue;
        reached[next] = 1;
        part.push_back(next);
      }
    }
    // What the rim of the map cuts may go on beyond it.
    const bool cut = std::any_of(part.begin(), part.end(), [&](Cell c) {
      return c.i <= frame_.i0 + 1 || c.j <= frame_.j0 + 1 || c.i >= frame_.i0 + frame_.width - 2 ||
             c.j >= frame_.j0 + frame_.height - 2;
    });
    if (cut || static_cast<double>(part.size()) * r * r >= kLeastPart) continue;
    for (const Cell c : part) wanted_[c] = 0;
  }
}

double AreaSources::outside(const Vector2d& p) const {
  double least = kInfinity;
  for (const Polygon& part : outside_) {
    least = std::min(least, std::max(0.0, signed_distance(part, p)));
  }
  return least;
}

float AreaSources::source(Cell c) const {
  if (wanted_.get(c, 0) != 0) return 0.0F;
  const bool beside_rim =
      std::min({c.i - frame_.i0, c.j - frame_.j0, frame_.i0 + frame_.width - 1 - c.i,
                frame_.j0 + frame_.height - 1 - c.j}) == 1;
  return static_cast<float>(beside_rim && !outside_.empty() ? beyond_ * outside(frame_.center(c))
                                                            : kInfinity);
}

}  // namespace prospect
