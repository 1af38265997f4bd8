// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/traversability.h"

namespace prospect {

/// What a metre costs more at a cell, driven in direction yaw in W [-], >= 0.
using PathPrice = std::function<double(Cell, double yaw)>;

/// How long the paths from one place are, over a coarse lattice: for comparing places, not for
/// driving.
///
/// Blocks of kSide x kSide cells, aligned in W. A block is as dear as its cheapest passable cell;
/// neighbours are joined where passable cells touch across their border, diagonal ones where both
/// ways round the corner are. The length is that of the shortest chain of blocks over eight
/// neighbours, times their factors [m of path equivalent]: at most 8 % more than along a straight
/// line, and within two blocks. A block may join what a wall thinner than itself parts; passable
/// cells on both sides of one are farther apart than a block wherever a robot fits.
///
/// A value. Thread-safety: concurrent reads are safe. Deterministic. Cost: update() linear in what
/// changed, flood() n log n in the blocks reached. Source: our choice.
class PathLengths {
 public:
  static constexpr int kSide = 3;
  static constexpr double kSettingOut = 1.0;  // [m] that tell the direction of a path

  /// What a search has found, and the memory that the next one works in.
  class Search {
    friend class PathLengths;
    std::vector<double> length, unpriced;  // by block
    std::vector<int> setting_out;          // block about 1 m from the start, on the path
    std::vector<int> reached;              // blocks with a length
    Cell start;                            // block
    using Entry = std::pair<double, int>;  // length, block
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  };

  /// Takes over what is passable, after each traversability.update().
  void update(const Traversability& traversability, const PausePoint& pause = {});

  /// The lengths from the block of `from`, as far as `limit` [m of path equivalent], and until
  /// enough(block, length) is true, asked of each block when its length is known; nowhere, if that
  /// block is not passable.
  template <typename Enough>
  void flood(Cell from, double limit, const Enough& enough, const PausePoint& pause = {}) {
    flood(search_, from, limit, enough, pause);
    begun_ = true;
  }
  /// The same beside the lengths that are kept here: they stay. A search is of one object.
  template <typename Enough>
  void flood(Search& search, Cell from, double limit, const Enough& enough,
             const PausePoint& pause = {}) const;
  void flood(Cell from, double limit = std::numeric_limits<double>::infinity()) {
    flood(from, limit, [](Cell, double) { return false; });
  }
  /// From a robot at that cell, nowhere yet: begins at all passable cells within 1 m that a line
  /// without occupied cells joins to it, as CostToGoField does, at ten times the distance to them.
  void begin_at_robot(const Traversability& traversability, Cell robot,
                      const PausePoint& pause = {});
  /// Goes on as far as `limit`. price: a metre costs 1 + price times as much; null: no more.
  void extend(double limit, const PathPrice& price = nullptr, const PausePoint& pause = {});

  /// Block that holds a cell.
  static Cell block_of(Cell c) { return {floor_divide(c.i, kSide), floor_divide(c.j, kSide)}; }

  /// Of the path from the last flood's start to the block of c [m of path equivalent]; +infinity
  /// beyond the limit, where it is not reached, and before the first flood.
  double length(Cell c) const;
  /// The same way without what the price adds.
  double unpriced(Cell c) const;
  /// Direction in W in which that way sets out, to its block about 1 m away [rad]; 0 where there is
  /// none.
  double departure(Cell c) const;

 private:
  double at(const std::vector<double>& values, Cell c) const;
  void begin(Search& search, Cell start, const PausePoint& pause) const;
  static void reach(Search& search, int block, double length, double unpriced, int setting_out);
  void refresh(Cell block, const Grid<float>& fine);
  template <typename Enough>
  void spread(Search& search, double limit, const PathPrice& price, const Enough& enough,
              const PausePoint& pause) const;

  Grid<float> factor_;         // 0: impassable
  Grid<std::uint8_t> joined_;  // bit 1: to the right neighbour, bit 2: to the upper one
  Search search_;
  bool begun_ = false;  // since the last update
};

template <typename Enough>
void PathLengths::flood(Search& search, Cell from, double limit, const Enough& enough,
                        const PausePoint& pause) const {
  begin(search, from, pause);
  if (factor_.get(search.start, 0.0F) == 0.0F) return;
  const int first = factor_.frame.index(search.start);
  reach(search, first, 0.0, 0.0, first);
  spread(search, limit, nullptr, enough, pause);
}

template <typename Enough>
void PathLengths::spread(Search& search, double limit, const PathPrice& price, const Enough& enough,
                         const PausePoint& pause) const {
  const GridFrame& f = factor_.frame;
  const int up = f.width;
  const auto joined = [&](int a, int bit) {
    return (joined_.data[static_cast<std::size_t>(a)] & bit) != 0;
  };
  // Of 4-neighbours; b is the neighbour of a at (di, dj).
  const auto open = [&](int a, int di, int dj) {
    if (di > 0) return joined(a, 1);
    if (di < 0) return joined(a - 1, 1);
    return dj > 0 ? joined(a, 2) : joined(a - up, 2);
  };
  std::size_t blocks = 0;
  while (!search.queue.empty()) {
    if (++blocks % 64 == 0) pause();
    const auto [length, index] = search.queue.top();
    if (length > limit) break;
    search.queue.pop();
    const auto here = static_cast<std::size_t>(index);
    if (length > search.length[here]) continue;
    const double factor = static_cast<double>(factor_.data[here]);
    const Cell at = f.at(index);
    if (enough(at, length)) break;
    const Cell middle{at.i * kSide + kSide / 2, at.j * kSide + kSide / 2};
    const bool out = (f.center(at) - f.center(search.start)).norm() >= kSettingOut;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        if (di == 0 && dj == 0) continue;
        const int n = index + dj * up + di;
        if (n < 0 || n >= f.size()) continue;
        const auto next = static_cast<std::size_t>(n);
        if (factor_.data[next] == 0.0F) continue;
        const bool diagonal = di != 0 && dj != 0;
        if (diagonal ? !(open(index, di, 0) && open(index + di, 0, dj) && open(index, 0, dj) &&
                         open(index + dj * up, di, 0))
                     : !open(index, di, dj)) {
          continue;
        }
        const double step = 0.5 * f.resolution * (diagonal ? std::numbers::sqrt2 : 1.0) *
                            (factor + static_cast<double>(factor_.data[next]));
        if (length + step >= search.length[next]) continue;
        const double priced = price ? step * (1.0 + price(middle, std::atan2(dj, di))) : step;
        reach(search, n, length + priced, search.unpriced[here] + step,
              out ? search.setting_out[here] : n);
      }
    }
  }
}

}  // namespace prospect
