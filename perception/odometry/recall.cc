// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/recall.h"

#include <limits>

#include "perception/odometry/median.h"

namespace prospect {

double RecallMemory::shift(const std::vector<Track>& tracks) const {
  std::vector<double> shifts;
  if (!recalls_.empty()) {
    // Both are in the order of their identifiers.
    auto before = recalls_.back().tracks.begin();
    const auto end = recalls_.back().tracks.end();
    for (const Track& now : tracks) {
      while (before != end && before->id < now.id) ++before;
      if (before == end) break;
      if (before->id == now.id && before->inlier && now.inlier) {
        shifts.push_back((now.left - before->left).norm());
      }
    }
  }
  return shifts.empty() ? std::numeric_limits<double>::infinity() : median(shifts);
}

}  // namespace prospect
