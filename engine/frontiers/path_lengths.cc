// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/path_lengths.h"

#include <cmath>

#include "engine/maps/free_line.h"

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNear = 1.0;         // [m] around a robot in which its path may begin
constexpr double kOffThePath = 10.0;  // [m of path equivalent per m] to where it begins

}  // namespace

// Anew from all its cells: factors may rise, too.
void PathLengths::refresh(Cell block, const Grid<float>& fine) {
  if (!factor_.frame.contains(block)) return;
  float cheapest = 0.0F;
  std::uint8_t joined = 0;
  for (int dj = 0; dj < kSide; ++dj) {
    for (int di = 0; di < kSide; ++di) {
      const Cell c{block.i * kSide + di, block.j * kSide + dj};
      const float here = fine.get(c, 0.0F);
      if (here == 0.0F) continue;
      if (cheapest == 0.0F || here < cheapest) cheapest = here;
      if (di == kSide - 1 && fine.get({c.i + 1, c.j}, 0.0F) != 0.0F) joined |= 1;
      if (dj == kSide - 1 && fine.get({c.i, c.j + 1}, 0.0F) != 0.0F) joined |= 2;
    }
  }
  factor_[block] = cheapest;
  joined_[block] = joined;
}

void PathLengths::update(const Traversability& traversability, const PausePoint& pause) {
  const Grid<float>& fine = traversability.factors();
  // One block more on every side: all neighbours exist.
  GridFrame blocks = frame_of_blocks(fine.frame, kSide);
  blocks.i0 -= 1;
  blocks.j0 -= 1;
  blocks.width += 2;
  blocks.height += 2;
  if (traversability.restarted() || factor_.data.empty()) {
    factor_ = Grid<float>(blocks, 0.0F, pause);
    joined_ = Grid<std::uint8_t>(blocks, 0, pause);
    for (int n = 0; n < blocks.size(); ++n) {
      if (n % 256 == 0) pause();
      refresh(blocks.at(n), fine);
    }
  } else {
    if (!(blocks == factor_.frame)) {
      factor_.widen(blocks, 0.0F, pause);
      joined_.widen(blocks, std::uint8_t{0}, pause);
    }
    std::size_t refreshed = 0;
    for (const Cell c : traversability.changed_factors()) {
      if (++refreshed % 256 == 0) pause();
      const Cell block = block_of(c);
      refresh(block, fine);
      // Whether a neighbour below is joined to it depends on its lowest cells.
      if (block_of({c.i - 1, c.j}).i != block.i) refresh({block.i - 1, block.j}, fine);
      if (block_of({c.i, c.j - 1}).j != block.j) refresh({block.i, block.j - 1}, fine);
    }
  }
  begun_ = false;
}

// Only what the search before has reached is to be taken back.
void PathLengths::begin(Search& search, Cell start, const PausePoint& pause) const {
  const std::size_t blocks = factor_.data.size();
  search.start = block_of(start);
  search.queue = {};
  if (search.setting_out.size() != blocks) {
    search.reached.clear();
    assign_in_pieces(search.length, blocks, kInfinity, pause);
    assign_in_pieces(search.unpriced, blocks, kInfinity, pause);
    assign_in_pieces(search.setting_out, blocks, -1, pause);
    return;
  }
  for (std::size_t n = 0; n < search.reached.size(); ++n) {
    if (n % 1024 == 0) pause();
    const auto at = static_cast<std::size_t>(search.reached[n]);
    search.length[at] = search.unpriced[at] = kInfinity;
    search.setting_out[at] = -1;
  }
  search.reached.clear();
}

void PathLengths::reach(Search& search, int block, double length, double unpriced,
                        int setting_out) {
  const auto at = static_cast<std::size_t>(block);
  if (length >= search.length[at]) return;
  if (search.length[at] == kInfinity) search.reached.push_back(block);
  search.length[at] = length;
  search.unpriced[at] = unpriced;
  search.setting_out[at] = setting_out;
  search.queue.emplace(length, block);
}

void PathLengths::begin_at_robot(const Traversability& traversability, Cell robot,
                                 const PausePoint& pause) {
  begin(search_, robot, pause);
  begun_ = true;
  const GridFrame& cells = traversability.frame();
  const int near = static_cast<int>(std::ceil(kNear / cells.resolution));
  for (int dj = -near; dj <= near; ++dj) {
    for (int di = -near; di <= near; ++di) {
      const Cell c{robot.i + di, robot.j + dj};
      const double distance = cells.resolution * std::hypot(di, dj);
      if (distance > kNear || !traversability.passable(c)) continue;
      const bool open = visit_line(cells, cells.center(robot), cells.center(c), [&](Cell on) {
        return on == robot || traversability.state(on) != CellState::kOccupied;
      });
      if (!open) continue;
      const int block = factor_.frame.index(block_of(c));
      reach(search_, block, kOffThePath * distance, distance, block);
    }
  }
}

void PathLengths::extend(double limit, const PathPrice& price, const PausePoint& pause) {
  spread(
      search_, limit, price, [](Cell, double) { return false; }, pause);
}

double PathLengths::at(const std::vector<double>& values, Cell c) const {
  const Cell block = block_of(c);
  if (!begun_ || !factor_.frame.contains(block)) return kInfinity;
  return values[static_cast<std::size_t>(factor_.frame.index(block))];
}

double PathLengths::length(Cell c) const { return at(search_.length, c); }

double PathLengths::unpriced(Cell c) const { return at(search_.unpriced, c); }

double PathLengths::departure(Cell c) const {
  const Cell block = block_of(c);
  if (!begun_ || !factor_.frame.contains(block)) return 0.0;
  const int out = search_.setting_out[static_cast<std::size_t>(factor_.frame.index(block))];
  if (out < 0) return 0.0;
  const Eigen::Vector2d d =
      factor_.frame.center(factor_.frame.at(out)) - factor_.frame.center(search_.start);
  return std::atan2(d.y(), d.x());
}

}  // namespace prospect
