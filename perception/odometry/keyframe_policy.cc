#include "perception/odometry/keyframe_policy.h"

namespace prospect {

std::string keyframe_reason(const KeyframeEvidence& evidence,
                            const KeyframePolicyOptions& options) {
  const bool moved = evidence.significance >= options.significance;
  // Few points are a reason at rest, too, but only once: if a keyframe found no more there are
  // none.
  if (evidence.points < options.min_points &&
      (moved || evidence.points < evidence.points_at_keyframe / 2)) {
    return "few points";
  }
  if (!moved) return {};
  if (evidence.points < options.min_share * evidence.points_at_keyframe) return "points lost";
  if (evidence.occupied_cells < options.min_share) return "image not covered";
  if (evidence.shift > options.max_shift * evidence.width) return "view changed";
  return {};
}

}  // namespace prospect
