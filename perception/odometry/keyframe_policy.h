// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace prospect {

class Knobs;

/// What a frame sees of the map.
struct KeyframeView {
  int points = 0;           ///< landmarks that fix its pose
  std::vector<char> cells;  ///< of its image that hold one of them, 0 or 1
  double sigma_position = 0.0,
         sigma_rotation = 0.0;  ///< of its pose given the landmarks [m], [rad]
};

/// What the choice of keyframes looks at. A keyframe is a frame at which new landmarks are made.
struct KeyframeEvidence {
  KeyframeView now;
  /// The best view since the last keyframe: that with the most points. Not what was made at the
  /// keyframe, since of new landmarks many are never found again.
  KeyframeView best;
  /// Median shift of the points since the last keyframe, as a share of the image's width.
  double shift = 0.0;
  /// Motion since the last keyframe over its own standard deviation.
  double significance = 0.0;
};

struct KeyframePolicyOptions {
  int min_points = 40;        ///< fewer: new ones are looked for as soon as the view changes
  double max_shift = 0.03;    ///< that counts as such a change; share of the image's width
  double min_share = 0.7;     ///< of the best view's points
  double min_cells = 0.75;    ///< of the cells that held a point in the best view
  double max_sigma = 2.0;     ///< of the pose, times that of the best view
  double significance = 5.0;  ///< below it the robot stands still
};

/// The knobs (models/knobs.h).
void describe(Knobs& knobs, KeyframePolicyOptions& options);

/// Whether to make a keyframe, and why; empty: no. Few keyframes drift less, since each fixes new
/// points with the pose's error. So one is made only when the map tells less of the pose than it
/// did: landmarks are lost, a part of the image has none left, or what is left fixes the pose half
/// as well. While the robot stands still none is made, however long it lasts, unless half of the
/// points are lost and few are left.
std::string keyframe_reason(const KeyframeEvidence& evidence,
                            const KeyframePolicyOptions& options = {});

}  // namespace prospect
