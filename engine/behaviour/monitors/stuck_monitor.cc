// SPDX-License-Identifier: Apache-2.0
#include "engine/behaviour/monitors/stuck_monitor.h"

#include <algorithm>
#include <cmath>

namespace prospect {

bool StuckMonitor::update(double stamp, const Eigen::Vector2d& position, bool tried) {
  if (!std::isfinite(stamp) || !position.allFinite()) return stuck_;
  const double passed = std::max(0.0, stamp - last_);
  last_ = stamp;
  if (!anchor_ || (position - *anchor_).norm() > (stuck_ ? kAway : kLeash)) {
    stuck_ = false;
    anchor_ = position;
    tried_for_ = 0.0;
    return false;
  }
  if (tried) tried_for_ += passed;
  stuck_ = stuck_ || tried_for_ > kPatience;
  return stuck_;
}

}  // namespace prospect
