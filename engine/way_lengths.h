#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "engine/grid.h"
#include "engine/traversability.h"

namespace prospect {

/// What a metre costs more at a cell, driven in direction yaw in W [-], >= 0.
using WayPrice = std::function<double(Cell, double yaw)>;

/// How long the ways from one place are, over a coarse lattice: for comparing places, not for
/// driving.
///
/// Blocks of kSide x kSide cells, aligned in W. A block is as dear as its cheapest passable cell;
/// neighbours are joined where passable cells touch across their border, diagonal ones where both
/// ways round the corner are. The length is that of the shortest chain of blocks over eight
/// neighbours, times their factors [m of path equivalent]: at most 8 % more than along a straight
/// line, and within two blocks. A block may join what a wall thinner than itself parts; passable
/// cells on both sides of one are farther apart than a block wherever a robot fits.
///
/// A value. Thread-safety: concurrent reads are safe. Deterministic. Cost: update() linear in the
/// cells, 1 ms for 0.3 million; flood() n log n in the blocks reached. Source: our choice.
class WayLengths {
 public:
  static constexpr int kSide = 3;

  /// Takes over what is passable.
  void update(const Traversability& traversability);

  /// The lengths from the block of `from`, as far as `limit` [m of path equivalent]; nowhere, if
  /// that block is not passable. price: a metre costs 1 + price times as much; null: no more.
  void flood(Cell from, double limit = std::numeric_limits<double>::infinity(),
             const WayPrice& price = nullptr);
  /// The same from a robot at that cell: from all passable cells within 1 m that a line without
  /// occupied cells joins to it, as CostToGoField does, at ten times the distance to them.
  void flood_from_robot(const Traversability& traversability, Cell robot,
                        const WayPrice& price = nullptr);

  /// Of the way from the last flood's start to the block of c [m of path equivalent]; +infinity
  /// beyond the limit, where it is not reached, and before the first flood.
  double length(Cell c) const;
  /// The same way without what the price adds.
  double unpriced(Cell c) const;
  /// Direction in W in which that way sets out, to its block about 1 m away [rad]; 0 where there is
  /// none.
  double departure(Cell c) const;

 private:
  Cell block_of(Cell c) const { return {floor_divide(c.i, kSide), floor_divide(c.j, kSide)}; }
  double at(const std::vector<double>& values, Cell c) const;
  void begin(Cell start);
  void reach(int block, double length, double unpriced, int setting_out);
  void spread(double limit, const WayPrice& price);

  Grid<float> factor_;          // 0: impassable
  Grid<std::uint8_t> joined_;   // bit 1: to the right neighbour, bit 2: to the upper one
  std::vector<double> length_;  // by block
  std::vector<double> unpriced_;
  std::vector<int> setting_out_;         // block about 1 m from the start, on the way
  Cell start_;                           // block
  using Entry = std::pair<double, int>;  // length, block
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace prospect
