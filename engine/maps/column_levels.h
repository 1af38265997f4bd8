// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <unordered_map>

#include "engine/maps/grid.h"

namespace prospect {

/// By how many layers each column of the maps that are derived from an octree is let down: voxel
/// (i, j, k) of a Belief's mirror is (i, j, k + level) of its octree, which is as things are. An
/// octree that knows of levels has this as a base, too; of a plain one all are 0, as where floors
/// are flat. Value type.
class ColumnLevels {
 public:
  ColumnLevels() = default;
  virtual ~ColumnLevels() = default;
  ColumnLevels(const ColumnLevels&) = default;
  ColumnLevels& operator=(const ColumnLevels&) = default;

  int level(Cell c) const {
    const auto found = levels_.empty() ? levels_.end() : levels_.find(key(c));
    return found == levels_.end() ? 0 : found->second;
  }
  void set_level(Cell c, int level) {
    if (level == 0) {
      levels_.erase(key(c));
    } else {
      levels_[key(c)] = level;
    }
  }

 private:
  static std::uint64_t key(Cell c) {
    return std::uint64_t{static_cast<std::uint32_t>(c.i)} << 32 | static_cast<std::uint32_t>(c.j);
  }

  std::unordered_map<std::uint64_t, int> levels_;
};

/// The level of a column of any octree.
template <typename OcTree>
int level_of(const OcTree& octree, Cell c) {
  const auto* levels = dynamic_cast<const ColumnLevels*>(&octree);
  return levels != nullptr ? levels->level(c) : 0;
}

}  // namespace prospect
