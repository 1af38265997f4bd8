// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/planar_move.h"

namespace prospect {

/// How places in W have moved at a correction, each with what it was seen from: a place goes with
/// the nearest of some places whose moves are known. Those are of the robot's way, half a metre
/// apart, so none is far.
///
/// An immutable value. Thread-safety: concurrent reads are safe. Deterministic.
class PlaceMoves {
 public:
  struct Known {
    Eigen::Vector2d before = Eigen::Vector2d::Zero();  ///< [m] in W
    PlanarMove move;
    /// Of where it is now as seen from the robot, along an axis [m^2]; negative: nobody knows.
    double variance = -1.0;
  };
  explicit PlaceMoves(std::vector<Known> known) : known_(std::move(known)) {}

  /// Of a place as it was before, or as it is now; none where nothing is known.
  PlanarMove of_before(const Eigen::Vector2d& p) const;
  PlanarMove of_now(const Eigen::Vector2d& p) const;
  /// Where a place is now that was at p, and where it was.
  Eigen::Vector2d now(const Eigen::Vector2d& p) const { return of_before(p)(p); }
  Pose now(const Pose& p) const { return of_before(p.position.head<2>())(p); }
  /// Known::variance of a place as it is now.
  double variance(const Eigen::Vector2d& p) const;
  Eigen::Vector2d before(const Eigen::Vector2d& p) const { return of_now(p).inverse()(p); }

  const std::vector<Known>& known() const { return known_; }

 private:
  std::vector<Known> known_;
};

/// What is known of cells, where these have moved: of each cell what was known of the place that
/// its middle holds now. Cells of the same frame; `unknown` where nothing was.
template <typename T>
Grid<T> moved(const Grid<T>& before, const PlaceMoves& moves, const T& unknown) {
  Grid<T> now(before.frame, unknown);
  constexpr int kTogether = 8;  // cells along an edge that move alike
  const GridFrame blocks = frame_of_blocks(before.frame, kTogether);
  for (int n = 0; before.frame.size() > 0 && n < blocks.size(); ++n) {
    const Cell block = blocks.at(n);
    std::optional<PlanarMove> back;
    for (int j = kTogether * block.j; j < kTogether * (block.j + 1); ++j) {
      for (int i = kTogether * block.i; i < kTogether * (block.i + 1); ++i) {
        if (!now.frame.contains({i, j})) continue;
        if (!back) back = moves.of_now(blocks.center(block)).inverse();
        const Eigen::Vector2d from = (*back)(now.frame.center({i, j}));
        now[{i, j}] = before.get(before.frame.cell(from.x(), from.y()), unknown);
      }
    }
  }
  return now;
}

}  // namespace prospect
