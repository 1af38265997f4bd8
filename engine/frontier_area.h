#pragma once

#include <cstdint>
#include <vector>

#include "engine/frontiers.h"
#include "engine/grid.h"
#include "engine/traversability.h"

namespace prospect {

/// m_c [m^2], the area that a frontier promises: unknown ground behind it with room for the robot.
///
///   m_c = r^2 |{ c : joined to a cell of the frontier by at most depth / r steps between
///                    4-neighbours, through unknown cells with Traversability::clear() only }|
///
/// A door of 1 m and the end of a corridor promise several square metres. The sliver that a corner
/// hid, the rim of a wall and a hole that noise left in it promise next to nothing, however long
/// they are: what is unknown there has no room for the robot, or walls that are known close it off.
/// Two doors to the same room promise the same ground twice, as nobody knows yet that it is one.
///
/// Depends on the present map and suppression only. Thread-safety: none (scratch); copies are
/// independent. Never throws after construction. Cost: linear in the cells counted. Source:
/// formulation, section 6 (m_c "area"); that room for the robot is asked for, and the depth, are
/// our choice.
class FrontierArea {
 public:
  /// depth [m]: 0 to 10, 0: only frontier cells themselves count. Throws std::invalid_argument
  /// naming the option, its value and what was expected.
  explicit FrontierArea(double depth);

  /// m_c of each frontier [m^2], 0 for those that are not active.
  /// suppressed: nonzero at frontier cells from which nothing is counted; an empty grid means none.
  std::vector<double> measure(const Traversability& traversability,
                              const std::vector<Frontier>& frontiers,
                              const Grid<std::uint8_t>& suppressed);

 private:
  int count(const Traversability& traversability, const Frontier& frontier,
            const Grid<std::uint8_t>& suppressed);

  double depth_;
  Grid<std::uint8_t> visited_;  // about one frontier
  std::vector<Cell> queue_;
};

}  // namespace prospect
