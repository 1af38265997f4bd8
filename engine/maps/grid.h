// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/support/resumable.h"
#include "models/types.h"

namespace prospect {

/// Integer address of a ground cell in the world-aligned lattice: cell (i, j) covers
/// [i r, (i+1) r) x [j r, (j+1) r) in W, r the resolution. Never relative to a map's corner, so an
/// address stays valid when a map grows.
struct Cell {
  int i = 0;
  int j = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Scan order: by row, then along it.
constexpr bool scan_less(Cell a, Cell b) { return a.j != b.j ? a.j < b.j : a.i < b.i; }

/// A rectangle of the world-aligned lattice of ground cells.
struct GridFrame {
  double resolution = 0.1;  ///< r [m]
  int i0 = 0, j0 = 0;       ///< address of the lowest cell
  int width = 0, height = 0;

  Cell cell(double x, double y) const {
    return {static_cast<int>(std::floor(x / resolution)),
            static_cast<int>(std::floor(y / resolution))};
  }
  Eigen::Vector2d center(Cell c) const {
    return {(c.i + 0.5) * resolution, (c.j + 0.5) * resolution};
  }
  bool contains(Cell c) const {
    return c.i >= i0 && c.i < i0 + width && c.j >= j0 && c.j < j0 + height;
  }
  /// Row-major index (x fastest); requires contains(c).
  int index(Cell c) const { return (c.j - j0) * width + (c.i - i0); }
  Cell at(int index) const { return {i0 + index % width, j0 + index / width}; }
  int size() const { return width * height; }
  friend bool operator==(const GridFrame&, const GridFrame&) = default;
};

/// a / b rounded down, b > 0.
constexpr int floor_divide(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// The frame of the blocks of side x side cells, aligned in W, that hold the cells of `fine`: cell
/// (i, j) lies in block (floor_divide(i, side), floor_divide(j, side)).
inline GridFrame frame_of_blocks(const GridFrame& fine, int side) {
  const int i0 = floor_divide(fine.i0, side), j0 = floor_divide(fine.j0, side);
  return {fine.resolution * side, i0, j0, floor_divide(fine.i0 + fine.width - 1, side) - i0 + 1,
          floor_divide(fine.j0 + fine.height - 1, side) - j0 + 1};
}

/// The least frame that holds two frames of one resolution, neither of them empty.
inline GridFrame frame_around_both(const GridFrame& a, const GridFrame& b) {
  GridFrame both = a;
  both.i0 = std::min(a.i0, b.i0);
  both.j0 = std::min(a.j0, b.j0);
  both.width = std::max(a.i0 + a.width, b.i0 + b.width) - both.i0;
  both.height = std::max(a.j0 + a.height, b.j0 + b.height) - both.j0;
  return both;
}

/// The least frame that holds two frames: where what is kept from a map at `before` goes on at
/// `now`. None if they differ in resolution, or if that frame had more than 10^5 cells and more
/// than four times those of `now`: then the maps are of different places, and nothing is kept.
inline std::optional<GridFrame> frame_of_both(const GridFrame& now, const GridFrame& before) {
  constexpr std::int64_t kAlways = 100'000, kTimes = 4;
  if (now.resolution != before.resolution) return std::nullopt;
  const GridFrame both = frame_around_both(now, before);
  const auto cells = [](const GridFrame& f) { return std::int64_t{f.width} * f.height; };
  if (cells(both) > std::max(kAlways, kTimes * cells(now))) return std::nullopt;
  return both;
}

/// The cells that two frames of one resolution share; of no width or height if there are none.
inline GridFrame intersection(const GridFrame& a, const GridFrame& b) {
  GridFrame common{a.resolution, std::max(a.i0, b.i0), std::max(a.j0, b.j0), 0, 0};
  common.width = std::max(0, std::min(a.i0 + a.width, b.i0 + b.width) - common.i0);
  common.height = std::max(0, std::min(a.j0 + a.height, b.j0 + b.height) - common.j0);
  return common;
}

/// The square of cells within `distance` [m] of a cell along either axis, rounded up to whole
/// cells.
inline GridFrame frame_around(Cell middle, double distance, double resolution) {
  const int reach = static_cast<int>(std::ceil(distance / resolution));
  return {resolution, middle.i - reach, middle.j - reach, 2 * reach + 1, 2 * reach + 1};
}

/// data.assign(size, value) in pieces: the memory of a large one takes long to be had.
template <typename T>
void assign_in_pieces(std::vector<T>& data, std::size_t size, const T& value,
                      const PausePoint& pause) {
  constexpr std::size_t kPiece = 65536;
  data.clear();
  data.reserve(size);
  while (data.size() < size) {
    data.resize(std::min(size, data.size() + kPiece), value);
    pause();
  }
}

/// Values on a rectangle of ground cells.
template <typename T>
struct Grid {
  GridFrame frame;
  std::vector<T> data;

  Grid() = default;
  Grid(const GridFrame& f, const T& value)
      : frame(f), data(static_cast<std::size_t>(f.size()), value) {}
  Grid(const GridFrame& f, const T& value, const PausePoint& pause) : frame(f) {
    assign_in_pieces(data, static_cast<std::size_t>(f.size()), value, pause);
  }
  T& operator[](Cell c) { return data[static_cast<std::size_t>(frame.index(c))]; }
  const T& operator[](Cell c) const { return data[static_cast<std::size_t>(frame.index(c))]; }
  /// The value at c, or `outside` beyond the rectangle.
  T get(Cell c, const T& outside) const { return frame.contains(c) ? (*this)[c] : outside; }
  /// Takes the frame `wider`, which holds the present one at the same resolution; new cells get
  /// `value`.
  void widen(const GridFrame& wider, const T& value, const PausePoint& pause = {}) {
    Grid wide(wider, value, pause);
    for (int j = frame.j0; j < frame.j0 + frame.height; ++j) {
      pause();
      std::copy_n(data.begin() + frame.index({frame.i0, j}), frame.width,
                  wide.data.begin() + wider.index({frame.i0, j}));
    }
    *this = std::move(wide);
  }
};

enum class CellState : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2 };

}  // namespace prospect
