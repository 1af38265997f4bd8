// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace prospect {

/// Square cells over an image, by which points are spread over it.
class ImageGrid {
 public:
  /// Sizes in px; the cell's side at least 1.
  ImageGrid(double width, double height, double cell)
      : cell_(cell),
        columns_(static_cast<int>(width / cell) + 1),
        rows_(static_cast<int>(height / cell) + 1) {}

  std::size_t cells() const { return static_cast<std::size_t>(columns_) * rows_; }
  /// The cell of a pixel, in [0, cells()); of one outside the image, that of the nearest edge.
  std::size_t cell(const Eigen::Vector2f& pixel) const {
    const int column = std::clamp(static_cast<int>(pixel.x() / cell_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(pixel.y() / cell_), 0, rows_ - 1);
    return static_cast<std::size_t>(row) * columns_ + column;
  }

 private:
  double cell_;
  int columns_, rows_;
};

}  // namespace prospect
