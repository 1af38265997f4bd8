// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "engine/maps/body_clearance.h"
#include "engine/maps/movers.h"
#include "engine/problem/term.h"

namespace prospect {

/// Soft cost of coming close to obstacles:
///   T = 1/(2N) sum over nodes k = 1..N and mid-points k+1/2, k = 0..N-1, of phi(d),
///   phi(d) = 1/2 (1 - tanh(alpha (d - beta))),  alpha = 6 / (d_des - d_safe),
///   beta = (d_des + d_safe) / 2,
/// so phi(d_safe) = 0.9975, phi(beta) = 1/2, phi(d_des) = 0.0025, and 0 < T < 1. d is the clearance
/// [m] at the pose of x_k, or at the mean of the poses of x_k and x_{k+1} (it differs from the pose
/// half-way along the arc by at most |acceleration| dt^2 / 8, 5 mm at 0.6 m/s, 1 rad/s and 0.25 s).
/// phi is flat deep inside obstacles; there the ClearanceConstraint carries the gradient.
///
/// With movers i (movers.h), which are obstacles where they are predicted for that node's time t,
/// the whole is that of being near any of them,
///   phi = 1 - (1 - phi(d)) product_i (1 - phi(d_i)),
///   d_i = |(x, y) - at_i(t)| - reach_i(t) - R,      R the body's circumscribed radius,
/// t = k dt of x_k. No constraint knows of them: the certificate does, and lets nobody wait for
/// ever.
///
/// Residuals: sqrt(phi / N), phi(d) = 1 / (1 + exp(2 alpha (d - beta))), of mid-point k+1/2 in row
/// 2k and of node k+1 in row 2k+1; smooth, as phi does not vanish.
///
/// Smoothness: C1, but where (x, y) = at_i(t). Thread-safety: const.
/// Source: formulation, section 5.
class ObstacleCost final : public Term {
 public:
  /// 0 <= d_safe < d_des [m]; throws std::invalid_argument otherwise, or if the clearance saturates
  /// below d_des (no pose could be free of cost).
  /// movers: at the time of x_0; radius: R [m].
  ObstacleCost(std::shared_ptr<const BodyClearance> clearance, double d_safe, double d_des,
               std::vector<Mover> movers = {}, double radius = 0.0);

  std::string_view name() const override { return "obstacles"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  /// phi at a pose and a time [s], and its derivatives by (x, y, z, yaw) where asked for.
  double phi_among_movers(const Pose& pose, double time, Eigen::Vector4d* slope) const;

  std::shared_ptr<const BodyClearance> clearance_;
  std::vector<Mover> movers_;
  double radius_ = 0.0;
  double alpha_ = 0.0;
  double beta_ = 0.0;
};

}  // namespace prospect
