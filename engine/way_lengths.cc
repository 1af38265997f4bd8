#include "engine/way_lengths.h"

#include <cmath>
#include <numbers>

#include "engine/free_line.h"

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSettingOut = 1.0;  // [m] that tell the direction of a way
constexpr double kNear = 1.0;        // [m] around a robot in which its way may begin
constexpr double kOffTheWay = 10.0;  // [m of path equivalent per m] to where it begins

}  // namespace

void WayLengths::update(const Traversability& traversability) {
  const Grid<float>& fine = traversability.factors();
  const GridFrame& f = fine.frame;
  // One block more on every side: all neighbours exist.
  GridFrame blocks = frame_of_blocks(f, kSide);
  blocks.i0 -= 1;
  blocks.j0 -= 1;
  blocks.width += 2;
  blocks.height += 2;
  factor_ = Grid<float>(blocks, 0.0F);
  joined_ = Grid<std::uint8_t>(blocks, 0);
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    const int bj = floor_divide(j, kSide);
    const bool top = floor_divide(j + 1, kSide) != bj && j + 1 < f.j0 + f.height;
    const float* row = &fine[{f.i0, j}];
    for (int i = 0; i < f.width; ++i) {
      if (row[i] == 0.0F) continue;
      const int bi = floor_divide(f.i0 + i, kSide);
      const Cell block{bi, bj};
      float& cheapest = factor_[block];
      if (cheapest == 0.0F || row[i] < cheapest) cheapest = row[i];
      const bool right = i + 1 < f.width && floor_divide(f.i0 + i + 1, kSide) != bi;
      if (right && row[i + 1] != 0.0F) joined_[block] |= 1;
      if (top && row[i + f.width] != 0.0F) joined_[block] |= 2;
    }
  }
  length_.clear();
}

void WayLengths::begin(Cell start) {
  length_.assign(factor_.data.size(), kInfinity);
  unpriced_.assign(factor_.data.size(), kInfinity);
  setting_out_.assign(factor_.data.size(), -1);
  start_ = block_of(start);
  queue_ = {};
}

void WayLengths::reach(int block, double length, double unpriced, int setting_out) {
  const auto at = static_cast<std::size_t>(block);
  if (length >= length_[at]) return;
  length_[at] = length;
  unpriced_[at] = unpriced;
  setting_out_[at] = setting_out;
  queue_.emplace(length, block);
}

void WayLengths::flood(Cell from, double limit, const WayPrice& price) {
  begin(from);
  if (factor_.get(start_, 0.0F) == 0.0F) return;
  const int first = factor_.frame.index(start_);
  reach(first, 0.0, 0.0, first);
  spread(limit, price);
}

void WayLengths::flood_from_robot(const Traversability& traversability, Cell robot,
                                  const WayPrice& price) {
  begin(robot);
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
      reach(block, kOffTheWay * distance, distance, block);
    }
  }
  spread(kInfinity, price);
}

void WayLengths::spread(double limit, const WayPrice& price) {
  const GridFrame& f = factor_.frame;
  const int up = f.width;
  const auto joined = [&](int a, int bit) {
    return (joined_.data[static_cast<std::size_t>(a)] & bit) != 0;
  };
  // Of 4-neighbours; b is the neighbour of a at (di, dj).
  const auto open = [&](int a, int di, int dj) {
    if (di > 0) return joined(a, 1);
    if (di < 0) return joined(a - 1, 1);
    return dj > 0 ? joined(a, 2) : joined(a - up, 2);
  };
  while (!queue_.empty()) {
    const auto [length, index] = queue_.top();
    queue_.pop();
    const auto here = static_cast<std::size_t>(index);
    if (length > length_[here]) continue;
    if (length > limit) break;
    const double factor = static_cast<double>(factor_.data[here]);
    const Cell at = f.at(index);
    const Cell middle{at.i * kSide + kSide / 2, at.j * kSide + kSide / 2};
    const bool out = (f.center(at) - f.center(start_)).norm() >= kSettingOut;
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        if (di == 0 && dj == 0) continue;
        const int n = index + dj * up + di;
        if (n < 0 || n >= f.size()) continue;
        const auto next = static_cast<std::size_t>(n);
        if (factor_.data[next] == 0.0F) continue;
        const bool diagonal = di != 0 && dj != 0;
        if (diagonal ? !(open(index, di, 0) && open(index + di, 0, dj) && open(index, 0, dj) &&
                         open(index + dj * up, di, 0))
                     : !open(index, di, dj)) {
          continue;
        }
        const double step = 0.5 * f.resolution * (diagonal ? std::numbers::sqrt2 : 1.0) *
                            (factor + static_cast<double>(factor_.data[next]));
        if (length + step >= length_[next]) continue;
        const double priced = price ? step * (1.0 + price(middle, std::atan2(dj, di))) : step;
        reach(n, length + priced, unpriced_[here] + step, out ? setting_out_[here] : n);
      }
    }
  }
}

double WayLengths::at(const std::vector<double>& values, Cell c) const {
  const Cell block = block_of(c);
  if (length_.empty() || !factor_.frame.contains(block)) return kInfinity;
  return values[static_cast<std::size_t>(factor_.frame.index(block))];
}

double WayLengths::length(Cell c) const { return at(length_, c); }

double WayLengths::unpriced(Cell c) const { return at(unpriced_, c); }

double WayLengths::departure(Cell c) const {
  const Cell block = block_of(c);
  if (length_.empty() || !factor_.frame.contains(block)) return 0.0;
  const int out = setting_out_[static_cast<std::size_t>(factor_.frame.index(block))];
  if (out < 0) return 0.0;
  const Eigen::Vector2d d =
      factor_.frame.center(factor_.frame.at(out)) - factor_.frame.center(start_);
  return std::atan2(d.y(), d.x());
}

}  // namespace prospect
