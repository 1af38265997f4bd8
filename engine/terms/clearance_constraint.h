// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "engine/maps/body_clearance.h"
#include "engine/problem/term.h"

namespace prospect {

/// Hard constraint d(x) >= d_safe at nodes and mid-points:
///   row k-1   (k = 1..N):    d(x_k) - s(k/N) >= 0
///   row N+k   (k = 0..N-1):  d((x_k + x_{k+1})/2) - s((k + 1/2)/N) >= 0        [m]
/// The mid-point is the mean of the two poses (see ObstacleCost for the O(dt^2) difference).
///
/// Relaxation, so that a robot that starts too close can leave. With d_0 = d(x_0) and t in [0, 1]
///   s(t) = d_safe                                     if d_0 >= d_safe
///        = max(floor, d_0 - slack)                    if floor <= d_0 < d_safe
///        = d_0 - slack + (floor + slack - d_0) t^2    if d_0 < floor
/// always capped at d_safe. In the middle case the robot may not come closer than it is, less a
/// slack for the interpolation; replanning repeatedly could creep inward by that slack, but never
/// below `floor`, which is absolute. Below the floor a plan must end above it (the square leaves
/// time to turn first). s depends on x_0 only, which is fixed while a problem is solved; the
/// Jacobian treats it as a constant.
///
/// Smoothness: C1. Thread-safety: const.
/// Source: formulation, section 5; the relaxation is our choice.
class ClearanceConstraint final : public Term {
 public:
  struct Options {
    double d_safe = 0.05;  ///< [m]
    double floor = 0.01;   ///< [m], <= d_safe
    double slack = 0.005;  ///< [m], >= 0
    std::string name = "clearance";
    TermQuantity quantity = TermQuantity::kClearance;
  };

  /// Throws std::invalid_argument for options out of range, or a clearance that saturates at or
  /// below d_safe.
  ClearanceConstraint(std::shared_ptr<const BodyClearance> clearance, Options options);

  std::string_view name() const override { return options_.name; }
  TermTraits traits() const override;
  int rows(const Horizon& horizon) const override { return 2 * horizon.N; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

  /// s(t) for a start with clearance d_0 [m].
  double required(double d_0, double t) const;

 private:
  std::shared_ptr<const BodyClearance> clearance_;
  Options options_;
};

}  // namespace prospect
