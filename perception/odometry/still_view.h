// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "perception/odometry/image_pyramid.h"

namespace prospect {

/// How much of a view is where it was in the image before.
struct StillView {
  int still = 0, changed = 0;  ///< parts of the image

  /// Whether it is no view at rest: more has changed than a thing that passes would, a sixth of
  /// what tells anything. What is still may then be carried along. It was `before`: as long as
  /// anything changes.
  bool moves(bool before) const {
    return before ? changed >= 2 : changed >= 4 && 5 * changed >= still;
  }
};

/// Compares two images of one size by 8 x 6 parts, each by the normalised correlation of what is
/// left of it without the mean of each row, so that another exposure, of all or of some rows, is no
/// change: still from 0.95 on, changed below 0.8. Parts of less contrast than three grey levels in
/// both images tell nothing. Deterministic; no state.
StillView still_view(const PyramidLevel& before, const PyramidLevel& now);

}  // namespace prospect
