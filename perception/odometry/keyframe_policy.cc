#include "perception/odometry/keyframe_policy.h"

#include "models/knobs.h"

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

void describe(Knobs& knobs, KeyframePolicyOptions& o) {
  knobs.integer("min_points", o.min_points, {0, 100000}, "1", "tracked; fewer: a new keyframe");
  knobs.number("min_share", o.min_share, {0.0, 1.0}, "1",
               "of the points at the last keyframe that are still tracked; less: a new one");
  knobs.number("max_shift", o.max_shift, {0.001, 1.0}, "1",
               "of the points since the last keyframe, as a share of the image's width");
  knobs.number("significance", o.significance, {0.0, 1e3}, "1",
               "of the motion, below which the robot stands still");
}

}  // namespace prospect
