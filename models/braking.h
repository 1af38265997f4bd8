// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace prospect {

/// The value nearest to zero that is reachable from `previous` at `rate` within dt, in [lower,
/// upper].
///   u = clamp(sign(previous) max(0, |previous| - rate dt), lower, upper).
/// A `previous` outside the bounds is brought inside at once: the bounds win over the rate.
inline double brake_velocity(double previous, double rate, double dt, double lower, double upper) {
  const double reach = rate * dt;
  const double u = previous - std::clamp(previous, -reach, reach);
  return std::clamp(u, lower, upper);
}

/// The acceleration that ends at zero velocity after dt, or the nearest admissible one.
inline double brake_acceleration(double velocity, double dt, double lower, double upper) {
  return std::clamp(-velocity / dt, lower, upper);
}

}  // namespace prospect
