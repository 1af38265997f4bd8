// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/keyframe_policy.h"

#include <algorithm>
#include <cstddef>

namespace prospect {
namespace {

/// Share of the best view's cells that still hold a point.
double cells_held(const KeyframeView& now, const KeyframeView& best) {
  int held = 0, were = 0;
  for (std::size_t i = 0; i < std::min(now.cells.size(), best.cells.size()); ++i) {
    were += best.cells[i];
    held += best.cells[i] && now.cells[i];
  }
  return were > 0 ? static_cast<double>(held) / were : 1.0;
}

}  // namespace

std::string keyframe_reason(const KeyframeEvidence& evidence,
                            const KeyframePolicyOptions& options) {
  const KeyframeView& now = evidence.now;
  const KeyframeView& best = evidence.best;
  const bool moved = evidence.significance >= options.significance;
  // Few points are a reason at rest, too, but only once: if a keyframe found no more there are
  // none.
  if (now.points < options.min_points &&
      (moved ? evidence.shift > options.max_shift : now.points < best.points / 2)) {
    return "few points";
  }
  if (!moved) return {};
  if (now.points < options.min_share * best.points) return "points lost";
  if (cells_held(now, best) < options.min_cells) return "image not covered";
  if (now.sigma_position > options.max_sigma * best.sigma_position ||
      now.sigma_rotation > options.max_sigma * best.sigma_rotation) {
    return "pose less certain";
  }
  return {};
}

}  // namespace prospect
