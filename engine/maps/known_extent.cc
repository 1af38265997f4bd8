// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/known_extent.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace prospect {

void KnownExtent::Rectangle::add(const Rectangle& o) {
  *this = {std::min(i0, o.i0), std::min(j0, o.j0), std::max(i1, o.i1), std::max(j1, o.j1)};
}

void KnownExtent::add(int i0, int j0, int i1, int j1) {
  const Rectangle added{i0, j0, i1, j1};
  if (all_) {
    all_->add(added);
  } else {
    all_ = added;
  }
  for (int j = floor_divide(j0, kBlock); j <= floor_divide(j1, kBlock); ++j) {
    for (int i = floor_divide(i0, kBlock); i <= floor_divide(i1, kBlock); ++i) {
      const long long low_i = 1LL * i * kBlock, low_j = 1LL * j * kBlock;
      const Rectangle part{std::max<long long>(i0, low_i), std::max<long long>(j0, low_j),
                           std::min<long long>(i1, low_i + kBlock - 1),
                           std::min<long long>(j1, low_j + kBlock - 1)};
      // Neighbours come one after the other, as a rule.
      if (newest_ == nullptr || newest_->first != std::pair(j, i)) {
        newest_ = &*blocks_.try_emplace({j, i}, Block{part}).first;
      }
      newest_->second.cells.add(part);
      newest_->second.count += part.cells();
    }
  }
}

KnownExtent::Rectangle KnownExtent::main_cluster(const PausePoint& pause) const {
  constexpr int kReach = kGap + 1;
  Blocks left = blocks_;
  Rectangle best{};
  long long most = -1;
  while (!left.empty()) {
    std::vector<Blocks::value_type> cluster{*left.begin()};
    left.erase(left.begin());
    long long count = 0;
    for (std::size_t n = 0; n < cluster.size(); ++n) {
      pause();
      count += cluster[n].second.count;
      const auto [j, i] = cluster[n].first;
      for (int dj = -kReach; dj <= kReach; ++dj) {
        for (int di = -kReach; di <= kReach; ++di) {
          const auto near = left.find({j + dj, i + di});
          if (near == left.end()) continue;
          cluster.push_back(*near);
          left.erase(near);
        }
      }
    }
    if (count <= most) continue;
    most = count;
    best = cluster.front().second.cells;
    for (const auto& [at, block] : cluster) best.add(block.cells);
  }
  return best;
}

GridFrame KnownExtent::frame(double resolution, const PausePoint& pause) const {
  if (!all_) return {resolution, 0, 0, 0, 0};
  const long long known = static_cast<long long>(blocks_.size()) * kBlock * kBlock;
  const Rectangle kept =
      all_->cells() > std::max(kAlways, kTimes * known) ? main_cluster(pause) : *all_;
  return {resolution, static_cast<int>(kept.i0), static_cast<int>(kept.j0),
          static_cast<int>(kept.i1 - kept.i0 + 1), static_cast<int>(kept.j1 - kept.j0 + 1)};
}

}  // namespace prospect
