#include "engine/way_lengths.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

namespace prospect {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSettingOut = 1.0;  // [m] that tell the direction of a way
constexpr double kNear = 1.0;        // [m] around a start that is not passable

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

void WayLengths::flood(Cell from, double limit, const WayPrice& price) {
  const GridFrame& f = factor_.frame;
  length_.assign(factor_.data.size(), kInfinity);
  unpriced_.assign(factor_.data.size(), kInfinity);
  setting_out_.assign(factor_.data.size(), -1);
  start_ = block_of(from);
  if (f.size() == 0) return;
  const int reach = static_cast<int>(std::ceil(kNear / f.resolution));
  int least = reach * reach + 1;
  Cell best = start_;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const Cell c{start_.i + di, start_.j + dj};
      const int distance = di * di + dj * dj;
      if (distance >= least || factor_.get(c, 0.0F) == 0.0F) continue;
      least = distance;
      best = c;
    }
  }
  if (factor_.get(best, 0.0F) == 0.0F) return;
  start_ = best;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const int first = f.index(start_);
  length_[static_cast<std::size_t>(first)] = unpriced_[static_cast<std::size_t>(first)] = 0.0;
  queue.emplace(0.0, first);
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
  while (!queue.empty()) {
    const auto [length, index] = queue.top();
    queue.pop();
    if (length > length_[static_cast<std::size_t>(index)]) continue;
    if (length > limit) break;
    const double factor = static_cast<double>(factor_.data[static_cast<std::size_t>(index)]);
    const Cell at = f.at(index);
    const Cell middle{at.i * kSide + kSide / 2, at.j * kSide + kSide / 2};
    const bool out = (f.center(f.at(index)) - f.center(start_)).norm() >= kSettingOut;
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
        const double reached = length + priced;
        if (reached >= length_[next]) continue;
        length_[next] = reached;
        unpriced_[next] = unpriced_[static_cast<std::size_t>(index)] + step;
        setting_out_[next] = out ? setting_out_[static_cast<std::size_t>(index)] : n;
        queue.emplace(reached, n);
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
