// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/maps/grid.h"

namespace prospect {

/// What squares of cells hold, in the order in which they were made. A square is found by its
/// address in a table of pointers over the rectangle of all of them, which grows with a margin.
/// Addresses of what it holds stay. Movable. Thread-safety: as a value.
template <typename T>
class BlockTable {
 public:
  bool empty() const { return all_.empty(); }
  std::size_t size() const { return all_.size(); }
  T& operator[](std::size_t n) const { return *all_[n]; }
  /// Null: there is none.
  T* find(Cell block) const { return at_.get(block, nullptr); }
  /// A new one, where there is none.
  T& add(Cell block) {
    if (!at_.frame.contains(block)) {
      constexpr int kMargin = 8;
      const GridFrame around{1.0, block.i - kMargin, block.j - kMargin, 2 * kMargin + 1,
                             2 * kMargin + 1};
      if (all_.empty()) {
        at_ = Grid<T*>(around, nullptr);
      } else {
        at_.widen(frame_around_both(at_.frame, around), nullptr);
      }
    }
    all_.push_back(std::make_unique<T>());
    return *(at_[block] = all_.back().get());
  }

 private:
  Grid<T*> at_;
  std::vector<std::unique_ptr<T>> all_;
};

}  // namespace prospect
