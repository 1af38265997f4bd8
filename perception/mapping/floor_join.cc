// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/floor_join.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace prospect {
namespace {

constexpr Cell kAround[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

int level_of(int k, int k_stand) { return std::max(0, k - k_stand); }

}  // namespace

FloorJoin::FloorJoin(const GridFrame& frame, int k_stand, double step, const Surfaces& surfaces)
    : step_(step),
      height_(frame, std::numeric_limits<float>::quiet_NaN()),
      level_(frame, 0),
      closed_(frame, 0) {
  std::vector<std::size_t> first;  // of each cell, and the end
  std::vector<FloorSurface> all;
  for (int n = 0; n < frame.size(); ++n) {
    first.push_back(all.size());
    surfaces(frame.at(n), all);
  }
  first.push_back(all.size());
  grow(first, all, k_stand);
  close();
  spread();
}

void FloorJoin::grow(const std::vector<std::size_t>& first, const std::vector<FloorSurface>& all,
                     int k_stand) {
  const GridFrame& f = height_.frame;
  const auto surfaces = [&](std::size_t at) {
    return std::span<const FloorSurface>(all).subspan(first[at], first[at + 1] - first[at]);
  };
  const auto take = [&](std::size_t at, const FloorSurface& surface) {
    height_.data[at] = static_cast<float>(surface.z);
    level_.data[at] = static_cast<std::int16_t>(level_of(surface.k, k_stand));
    order_.push_back(static_cast<int>(at));
  };
  for (std::size_t at = 0; at + 1 < first.size(); ++at) {
    const FloorSurface* highest = nullptr;
    for (const FloorSurface& s : surfaces(at)) {
      if (s.k <= k_stand && (highest == nullptr || s.k > highest->k)) highest = &s;
    }
    if (highest != nullptr) take(at, *highest);
  }
  for (std::size_t next = 0; next < order_.size(); ++next) {
    const Cell c = f.at(order_[next]);
    const double from = height_[c];
    for (const Cell d : kAround) {
      const Cell to{c.i + d.i, c.j + d.j};
      if (!f.contains(to) || !std::isnan(height_[to])) continue;
      const double way = f.resolution * std::hypot(d.i, d.j);
      const auto at = static_cast<std::size_t>(f.index(to));
      const FloorSurface* best = nullptr;
      for (const FloorSurface& s : surfaces(at)) {
        const double off = std::abs(s.z - from);
        if (joins(off, way, step_) && (best == nullptr || off < std::abs(best->z - from))) {
          best = &s;
        }
      }
      if (best != nullptr) take(at, *best);
    }
  }
}

void FloorJoin::close() {
  const GridFrame& f = height_.frame;
  for (const int n : order_) {
    const Cell c = f.at(n);
    const double high = height_[c];
    if (!(high > step_)) continue;  // nothing that is floor lies so far below it
    for (const Cell d : kAround) {
      const double stride = f.resolution * std::hypot(d.i, d.j);
      double before = high;
      for (int steps = 1; steps * stride <= kBaseline; ++steps) {
        const double low = height({c.i + steps * d.i, c.j + steps * d.j});
        // Beyond an edge another floor begins: the cell at the edge alone is closed.
        if (std::isnan(low) || (steps > 1 && !joins(std::abs(before - low), stride, step_))) {
          break;
        }
        before = low;
        if (joins(high - low, steps * stride, step_)) continue;
        for (int at = 0; at < steps; ++at) closed_[{c.i + at * d.i, c.j + at * d.j}] = 1;
        break;
      }
    }
  }
}

void FloorJoin::spread() {
  const GridFrame& f = level_.frame;
  std::vector<char> known(level_.data.size(), 0);
  for (const int n : order_) known[static_cast<std::size_t>(n)] = 1;
  for (std::size_t next = 0; next < order_.size(); ++next) {
    const Cell c = f.at(order_[next]);
    for (const Cell d : kAround) {
      const Cell to{c.i + d.i, c.j + d.j};
      if (!f.contains(to)) continue;
      const auto at = static_cast<std::size_t>(f.index(to));
      if (known[at]) continue;
      known[at] = 1;
      level_.data[at] = level_[c];
      order_.push_back(static_cast<int>(at));
    }
  }
}

}  // namespace prospect
