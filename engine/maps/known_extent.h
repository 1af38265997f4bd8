// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "engine/maps/grid.h"
#include "engine/support/resumable.h"

namespace prospect {

/// How large a map has to be. Maps are rectangles; one voxel that an error of a sensor or a jump of
/// the pose puts far away would make them as large as the way there.
///
/// Known cells are noted by blocks of kBlock x kBlock cells, aligned in W. The extent is the
/// rectangle of all, if it has at most kAlways cells or at most kTimes those of its blocks. Else it
/// is that of one cluster: of blocks with at most kGap empty ones between them, the cluster in
/// which most cells were noted, of equal ones the first in scan order. What lies apart is left out.
///
/// Deterministic: the order in which cells are noted does not matter. Source: our choice.
class KnownExtent {
 public:
  static constexpr int kBlock = 64, kGap = 2, kTimes = 16;
  static constexpr long long kAlways = 4'000'000;

  KnownExtent() = default;
  KnownExtent(const KnownExtent&) = delete;
  KnownExtent& operator=(const KnownExtent&) = delete;

  /// Cells of the rectangle [i0, i1] x [j0, j1] are known.
  void add(int i0, int j0, int i1, int j1);
  /// Of no width if nothing was added. resolution: of the frame [m].
  GridFrame frame(double resolution, const PausePoint& pause = {}) const;

 private:
  struct Rectangle {
    long long i0, j0, i1, j1;  // inclusive
    void add(const Rectangle& other);
    long long cells() const { return (i1 - i0 + 1) * (j1 - j0 + 1); }
  };
  struct Block {
    Rectangle cells;      // that are known
    long long count = 0;  // how often one was added
  };
  using Blocks = std::map<std::pair<int, int>, Block>;  // by (j, i)
  Rectangle main_cluster(const PausePoint& pause) const;

  Blocks blocks_;
  Blocks::value_type* newest_ = nullptr;  // of them
  std::optional<Rectangle> all_;
};

}  // namespace prospect
