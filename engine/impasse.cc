#include "engine/impasse.h"

#include <algorithm>
#include <cmath>

namespace prospect {

bool Impasse::update(double stamp, const Eigen::Vector2d& position, bool tried) {
  if (!std::isfinite(stamp) || !position.allFinite()) return inside_;
  const double passed = std::max(0.0, stamp - last_);
  last_ = stamp;
  if (!anchor_ || (position - *anchor_).norm() > (inside_ ? kAway : kLeash)) {
    inside_ = false;
    anchor_ = position;
    tried_for_ = 0.0;
    return false;
  }
  if (tried) tried_for_ += passed;
  inside_ = inside_ || tried_for_ > kPatience;
  return inside_;
}

}  // namespace prospect
