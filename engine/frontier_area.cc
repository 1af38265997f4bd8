#include "engine/frontier_area.h"

#include <algorithm>
#include <cmath>

#include "models/parameter_check.h"

namespace prospect {

FrontierArea::FrontierArea(double depth) : depth_(depth) {
  check_parameter(depth >= 0.0 && depth <= 10.0, "frontier area", "depth", depth, "0 to 10 m");
}

std::vector<double> FrontierArea::measure(const Traversability& traversability,
                                          const std::vector<Frontier>& frontiers,
                                          const Grid<std::uint8_t>& suppressed) {
  const double r = traversability.frame().resolution;
  std::vector<double> area(frontiers.size(), 0.0);
  for (std::size_t k = 0; k < frontiers.size(); ++k) {
    if (frontiers[k].active) area[k] = r * r * count(traversability, frontiers[k], suppressed);
  }
  return area;
}

int FrontierArea::count(const Traversability& traversability, const Frontier& frontier,
                        const Grid<std::uint8_t>& suppressed) {
  const double r = traversability.frame().resolution;
  const int steps = static_cast<int>(std::floor(depth_ / r + 1e-9));
  int i0 = frontier.cells.front().i, i1 = i0;
  for (const Cell c : frontier.cells) {
    i0 = std::min(i0, c.i);
    i1 = std::max(i1, c.i);
  }
  const int j0 = frontier.cells.front().j, j1 = frontier.cells.back().j;  // in scan order
  visited_.frame = {r, i0 - steps, j0 - steps, i1 - i0 + 1 + 2 * steps, j1 - j0 + 1 + 2 * steps};
  visited_.data.assign(static_cast<std::size_t>(visited_.frame.size()), 0);
  queue_.clear();

  const auto visit = [&](Cell c) {
    std::uint8_t& visited = visited_[c];
    if (visited != 0) return;
    visited = 1;
    // Beyond the map everything is unknown and clear.
    if (traversability.state(c) == CellState::kUnknown && traversability.clear(c)) {
      queue_.push_back(c);
    }
  };
  for (const Cell c : frontier.cells) {
    if (suppressed.get(c, 0) == 0) visit(c);
  }
  std::size_t next = 0;
  for (int step = 0; step < steps && next < queue_.size(); ++step) {
    for (const std::size_t end = queue_.size(); next < end; ++next) {
      const Cell c = queue_[next];
      visit({c.i + 1, c.j});
      visit({c.i - 1, c.j});
      visit({c.i, c.j + 1});
      visit({c.i, c.j - 1});
    }
  }
  return static_cast<int>(queue_.size());
}

}  // namespace prospect
