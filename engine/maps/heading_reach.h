// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "engine/maps/grid.h"
#include "engine/maps/heading_fit.h"

namespace prospect {

/// Where a body that is not round gets to, by place and heading.
///
/// States are a cell and a heading at which the body fits on its centre. From a state it
///   turns to the next heading either way, if it fits there, too;
///   moves to one of the four neighbours at the same heading, if it fits there, too.
/// A base that can reverse or move sideways may do so towards all four: one that drives and
/// reverses is small-time locally controllable, so whatever is joined in the open set of poses that
/// fit can be driven, with turns to and fro where it must go sideways. Moves are symmetric then: it
/// gets out of where it got in.
/// One that only drives forward moves to neighbours less than 90 degrees off its heading, and gets
/// into places out of which it does not get: a corridor too narrow to turn in, with no path on.
/// These do not count: a state is reached only if one can be reached from it in which the body can
/// turn all round (unless none can be reached from the start, or the start is such a place itself).
///
/// Swept area between neighbouring states is not looked at: less than a millimetre in a turn, at
/// most half a cell's corner in a move. What may be driven is decided by the certificate.
///
/// A value. Thread-safety: concurrent reads are safe. Deterministic: the reach is the one least
/// fixed point, whatever the order. Source: our choice.
class HeadingReach {
 public:
  /// fits: the headings at each cell; nothing fits beyond the frame. start: position in W [m] and
  /// yaw [rad] of the body. Its state is the nearest one that fits, by the distance to the cell's
  /// centre plus 0.5 m a radian, within 1 m, to whose cell a line leads that meets no cell for
  /// which solid() is true but the body's own; without one nothing is reached. free_moves: the base
  /// can reverse or move sideways.
  void update(const Grid<HeadingMask>& fits, const Eigen::Vector2d& position, double yaw,
              bool free_moves, const std::function<bool(Cell)>& solid,
              const PausePoint& pause = {});

  /// Whether the last update found a state to start from.
  bool started() const { return started_; }
  /// Headings reached at each cell, in the frame of `fits`.
  const Grid<HeadingMask>& reached() const { return reached_; }

 private:
  // The headings with which the body may move towards the neighbour in +x, +y, -x, -y.
  using Steps = std::array<HeadingMask, 4>;
  static std::optional<std::pair<Cell, int>> find_start(const Grid<HeadingMask>& fits,
                                                        const Eigen::Vector2d& position, double yaw,
                                                        const std::function<bool(Cell)>& solid);
  void begin(int cell, bool all);
  void enter(const Grid<HeadingMask>& fits, std::size_t cell, HeadingMask with,
             Grid<HeadingMask>& reached);
  void flood(const Grid<HeadingMask>& fits, const Steps& steps, Grid<HeadingMask>& reached,
             const PausePoint& pause);

  Grid<HeadingMask> reached_;
  Grid<HeadingMask> turning_;  // states from which the body gets to where it can turn all round
  bool started_ = false;
  // Cells whose neighbours are to be looked at: those with all headings, and others.
  std::vector<int> open_, waiting_;
  std::vector<std::uint8_t> is_open_;
};

/// The headings of `within` that are joined to one of `some` by turning through headings of it.
HeadingMask turned_through(HeadingMask some, HeadingMask within);

}  // namespace prospect
