// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "engine/maps/ground_map.h"
#include "models/types.h"

namespace prospect::test {

/// True ground plans and a depth sensor for tests: everything on the lattice, exact, deterministic.
struct GroundWorld {
  Grid<CellState> truth;  // free or occupied

  /// A block of rooms of about 4 m with doors and boxes, outer wall closed. metres: side of the
  /// square.
  static GroundWorld rooms(double metres, double resolution, int boxes, std::mt19937_64& random) {
    const int n = static_cast<int>(metres / resolution);
    GroundWorld w{Grid<CellState>(GridFrame{resolution, 0, 0, n, n}, CellState::kFree)};
    const int room = static_cast<int>(4.0 / resolution);
    const int door = static_cast<int>(1.0 / resolution);
    const auto fill = [&](int i0, int j0, int i1, int j1, CellState s) {
      for (int j = std::max(0, j0); j < std::min(n, j1); ++j) {
        for (int i = std::max(0, i0); i < std::min(n, i1); ++i) w.truth[{i, j}] = s;
      }
    };
    for (int k = room; k + room / 2 < n; k += room) {
      fill(k, 0, k + 1, n, CellState::kOccupied);
      fill(0, k, n, k + 1, CellState::kOccupied);
    }
    for (int k = room; k + room / 2 < n; k += room) {
      for (int a = 0; a < n; a += room) {
        const int at = a + 3 + static_cast<int>(random() % static_cast<unsigned>(room - door - 5));
        fill(k, at, k + 1, at + door, CellState::kFree);
        fill(at, k, at + door, k + 1, CellState::kFree);
      }
    }
    for (int b = 0; b < boxes; ++b) {
      const int i = static_cast<int>(random() % static_cast<unsigned>(n));
      const int j = static_cast<int>(random() % static_cast<unsigned>(n));
      const int a = 1 + static_cast<int>(random() % 6), c = 1 + static_cast<int>(random() % 6);
      fill(i, j, i + a, j + c, CellState::kOccupied);
    }
    fill(0, 0, n, 2, CellState::kOccupied);
    fill(0, n - 2, n, n, CellState::kOccupied);
    fill(0, 0, 2, n, CellState::kOccupied);
    fill(n - 2, 0, n, n, CellState::kOccupied);
    return w;
  }

  bool occupied(Cell c) const { return truth.get(c, CellState::kOccupied) == CellState::kOccupied; }

  /// A free cell with no occupied cell within `margin` cells, drawn at random.
  Cell open_cell(int margin, std::mt19937_64& random) const {
    while (true) {
      const Cell c = truth.frame.at(
          static_cast<int>(random() % static_cast<std::uint64_t>(truth.frame.size())));
      bool open = true;
      for (int dj = -margin; dj <= margin && open; ++dj) {
        for (int di = -margin; di <= margin && open; ++di) open = !occupied({c.i + di, c.j + dj});
      }
      if (open) return c;
    }
  }

  /// Marks what a depth image from `pose` shows, and the robot's footprint as free.
  void sense(const Pose& pose, double range, double fov, GroundMap& map) const {
    const double r = truth.frame.resolution;
    const Cell here = truth.frame.cell(pose.position.x(), pose.position.y());
    const int body = static_cast<int>(std::ceil(0.3 / r));
    for (int dj = -body; dj <= body; ++dj) {
      for (int di = -body; di <= body; ++di) {
        const Cell c{here.i + di, here.j + dj};
        if (di * di + dj * dj <= body * body && !occupied(c)) map.set(c, CellState::kFree);
      }
    }
    for (double a = -0.5 * fov; a <= 0.5 * fov; a += 0.0125) {
      const double x = std::cos(pose.yaw + a), y = std::sin(pose.yaw + a);
      for (double s = 0.0; s <= range; s += 0.4 * r) {
        const Cell c = truth.frame.cell(pose.position.x() + s * x, pose.position.y() + s * y);
        if (occupied(c)) {
          if (truth.frame.contains(c)) map.set(c, CellState::kOccupied);
          break;
        }
        map.set(c, CellState::kFree);
      }
    }
  }
};

/// Distance [m] from the centre of c to the square of the nearest cell in that state, one by one,
/// infinity if there is none within `reach` cells along either axis.
inline double slow_distance(const GroundMap& map, Cell c, CellState target, int reach) {
  const double r = map.frame().resolution;
  double least = std::numeric_limits<double>::infinity();
  for (int j = c.j - reach; j <= c.j + reach; ++j) {
    for (int i = c.i - reach; i <= c.i + reach; ++i) {
      if (map.state({i, j}) != target) continue;
      const double dx = r * std::max(0.0, std::abs(i - c.i) - 0.5);
      const double dy = r * std::max(0.0, std::abs(j - c.j) - 0.5);
      least = std::min(least, std::hypot(dx, dy));
    }
  }
  return least;
}

/// A known room, free from 0.8 m to 6.7 m along x and to 4.7 m along y, with walls 3 cells thick;
/// in a map of `width` cells. What the east wall holds at the rows for which hole(j) is unknown.
template <typename Hole>
GroundMap known_room(int width, const Hole& hole) {
  GroundMap map(GridFrame{0.1, 0, 0, width, 60});
  for (int j = 5; j < 50; ++j) {
    for (int i = 5; i < 70; ++i) {
      const bool wall = i < 8 || i > 66 || j < 8 || j > 46;
      if (i > 66 && hole(j)) continue;
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

/// A map with rectangles of random states, as cluttered and torn as can be.
inline void scribble(GroundMap& map, int count, int span, int lowest, std::mt19937_64& random) {
  for (int k = 0; k < count; ++k) {
    const auto draw = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const int i0 = lowest + draw(span), j0 = lowest + draw(span);
    const int w = 1 + draw(12), h = 1 + draw(12);
    const int kind = draw(10);
    const CellState s = kind < 6   ? CellState::kFree
                        : kind < 8 ? CellState::kOccupied
                                   : CellState::kUnknown;
    const int shrink = s == CellState::kOccupied ? 3 : 1;
    for (int j = j0; j < j0 + (h + shrink - 1) / shrink; ++j) {
      for (int i = i0; i < i0 + (w + shrink - 1) / shrink; ++i) map.set({i, j}, s);
    }
  }
}

}  // namespace prospect::test
