#include "engine/impasse.h"

#include <algorithm>
#include <cmath>

namespace prospect {

bool Impasse::update(double stamp, const Eigen::Vector2d& position, bool tried) {
  if (!std::isfinite(stamp) || !position.allFinite()) return inside_;
  const double passed = begun_ ? std::max(0.0, stamp - last_) : 0.0;
  last_ = stamp;
  if (!begun_ || (position - anchor_).norm() > (inside_ ? kAway : kLeash)) {
    begun_ = true;
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
