// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "engine/problem/problem.h"

namespace prospect {

/// Makes knot inputs keep the model's rate limits, one knot after the other:
///
///   u_m <- clamp(u_m, u_{m-1} - rate dt, u_{m-1} + rate dt),  then into the bounds,
///
/// u_{-1} being the input in force. The limit is that of one stage, since the input changes between
/// the last stage of a knot and the first of the next. Points that keep the limits are not changed.
/// The set of points that keep them is convex, so means of projected points keep them too.
///
/// Thread-safety: const.
class RateProjection {
 public:
  explicit RateProjection(const Problem& problem);
  /// False: the model has no finite rate limit, apply() does nothing.
  bool active() const { return active_; }
  /// z: n.
  void apply(Eigen::Ref<Eigen::VectorXd> z) const;

 private:
  const Problem& problem_;
  Eigen::VectorXd step_;  // nu, rate dt
  bool active_;
};

}  // namespace prospect
