// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "engine/maps/grid.h"

namespace prospect {

/// Visits the cells that the segment from `from` to `to` [m, in W] pierces, in order, both ends
/// included, until visit(cell) returns false; whether it visited all. A segment through a corner of
/// the lattice visits one of the two cells beside it, so it never slips between two cells that
/// touch there. Finite points only. No allocation; safe to call concurrently.
template <typename Visit>
bool visit_line(const GridFrame& frame, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                Visit&& visit) {
  const Eigen::Vector2d a = from / frame.resolution;
  const Eigen::Vector2d b = to / frame.resolution;
  int i = static_cast<int>(std::floor(a.x()));
  int j = static_cast<int>(std::floor(a.y()));
  const int last_i = static_cast<int>(std::floor(b.x()));
  const int last_j = static_cast<int>(std::floor(b.y()));
  const double dx = b.x() - a.x();
  const double dy = b.y() - a.y();
  const int step_i = last_i > i ? 1 : -1;
  const int step_j = last_j > j ? 1 : -1;
  int left_i = std::abs(last_i - i);
  int left_j = std::abs(last_j - j);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // Parameters of the segment at the next crossings of lattice lines.
  double next_i = left_i > 0 ? ((step_i > 0 ? i + 1 : i) - a.x()) / dx : kNever;
  double next_j = left_j > 0 ? ((step_j > 0 ? j + 1 : j) - a.y()) / dy : kNever;
  const double delta_i = left_i > 0 ? step_i / dx : 0.0;
  const double delta_j = left_j > 0 ? step_j / dy : 0.0;
  while (true) {
    if (!visit(Cell{i, j})) return false;
    if (left_i == 0 && left_j == 0) return true;
    if (next_i <= next_j) {
      i += step_i;
      next_i = --left_i > 0 ? next_i + delta_i : kNever;
    } else {
      j += step_j;
      next_j = --left_j > 0 ? next_j + delta_j : kNever;
    }
  }
}

/// Whether all cells between those of `from` and `to`, both excluded, are seen through.
inline bool line_of_sight(const Grid<std::uint8_t>& see_through, const Eigen::Vector2d& from,
                          const Eigen::Vector2d& to) {
  const Cell first = see_through.frame.cell(from.x(), from.y());
  const Cell last = see_through.frame.cell(to.x(), to.y());
  return visit_line(see_through.frame, from, to,
                    [&](Cell c) { return c == first || c == last || see_through.get(c, 0) != 0; });
}

}  // namespace prospect
