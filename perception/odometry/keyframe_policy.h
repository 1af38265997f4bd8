#pragma once

#include <string>

namespace prospect {

class Knobs;

/// What the choice of keyframes looks at. A keyframe is a frame at which new landmarks are made.
struct KeyframeEvidence {
  int points = 0;              ///< landmarks that fix the newest pose
  int points_at_keyframe = 0;  ///< how many there were after the last keyframe
  double occupied_cells =
      1.0;  ///< share of the last keyframe's image cells that still hold a point
  /// Median shift of the points since the last keyframe [px], and the image's width [px].
  double shift = 0.0;
  double width = 640.0;
  /// Motion since the last keyframe over its own standard deviation.
  double significance = 0.0;
};

struct KeyframePolicyOptions {
  int min_points = 40;
  double min_share = 0.75;    ///< of the points at the last keyframe, and of the cells
  double max_shift = 0.03;    ///< share of the image's width
  double significance = 5.0;  ///< below it the robot stands still
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, KeyframePolicyOptions& options);

/// Whether to make a keyframe, and why; empty: no. Few keyframes drift less (each fixes new points
/// with the pose's error), so one is made only when the view has changed. While the robot stands
/// still none is made, however long it lasts, unless points are too few to go on with.
std::string keyframe_reason(const KeyframeEvidence& evidence,
                            const KeyframePolicyOptions& options = {});

}  // namespace prospect
