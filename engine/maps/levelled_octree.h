// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <octomap/OcTree.h>

#include <cstdint>
#include <unordered_map>

#include "engine/maps/grid.h"

namespace prospect {

/// An octree of things as they are, and by how many layers each column of the maps that are derived
/// from it is let down: voxel (i, j, k) of a Belief's mirror is (i, j, k + level) of its octree.
/// Where floors are flat, and in a plain octree, no column is. Value type.
class LevelledOcTree : public octomap::OcTree {
 public:
  explicit LevelledOcTree(double resolution) : octomap::OcTree(resolution) {}

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

/// The same of any octree.
inline int level_of(const octomap::OcTree& octree, Cell c) {
  const auto* levelled = dynamic_cast<const LevelledOcTree*>(&octree);
  return levelled != nullptr ? levelled->level(c) : 0;
}

}  // namespace prospect
