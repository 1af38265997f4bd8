// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/frame_clock.h"

#include <algorithm>
#include <cmath>

namespace prospect {

std::string FrameClock::tick(double stamp) {
  if (!std::isfinite(stamp)) return "the time is not a number";
  if (last_ && !(stamp > *last_)) return "the time does not increase";
  step_ = last_ ? stamp - *last_ : 0.0;
  last_ = stamp;
  gap_ = period_ > 0.0 && step_ > max_gap_ * period_;
  if (step_ > 0.0) {
    period_ = period_ > 0.0 ? std::min(1.1 * period_, std::max(0.9 * period_, step_)) : step_;
  }
  return {};
}

}  // namespace prospect
