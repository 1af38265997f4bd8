// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "engine/maps/body_clearance.h"
#include "engine/maps/unknown_policy.h"
#include "engine/problem/term.h"

namespace prospect {

/// The robot can stop inside known free space:
///   row k-1 (k = 1..N):  d_known(q_k) - s >= 0      [m]
/// d_known: clearance to whatever is not known to be free (a field with kOccupiedAndUnknown);
/// q_k: the pose at which it comes to rest when it brakes from x_k on along the arc that it drives,
///   D = p_k - p_{k-1}, delta = yaw_k - yaw_{k-1}:  the way that led to x_k,
///   l = |v_k|^2 / (2 a),  theta = delta |v_k| / (2 a dt):  way and turn until it stands,
///   q_k = (p_k + l Rz((delta + theta) / 2) D / |D|,  yaw_k + theta),
/// |v_k|^2 the squared speed with which x_k is reached, model.squared_speed(x_k, u_{k-1}),
/// a = deceleration. |D| and |v_k| are rounded off within 1 mm and 1 cm/s of rest, so that q_k is
/// smooth there. So a wall beside the way does not slow the robot down, what is ahead does. The
/// poses on the way to q_k are those of other rows, or nearly: the certificate checks them all.
///   s = min(margin, max(floor, d_known(x_0) - slack)),
/// so that a robot that wakes up surrounded by what it has not seen may still turn on the spot and
/// look, though not drive on: floor is absolute, -largest bounding radius by default, which keeps
/// the body's centre inside known space. s depends on x_0 only and counts as a constant in the
/// Jacobian.
///
/// Smoothness: C1. Thread-safety: const.
/// Source: formulation, section 5; the place of rest and the relaxation are our choice.
class BrakingConstraint final : public Term {
 public:
  struct Options {
    double margin = 0.05;       ///< [m]
    double deceleration = 0.0;  ///< a [m/s^2]; 0: the model's max_deceleration()
    double slack = 0.005;       ///< [m]
  };

  /// Throws std::invalid_argument for options out of range or a clearance that saturates at or
  /// below the margin.
  BrakingConstraint(std::shared_ptr<const BodyClearance> known, Options options);

  std::string_view name() const override { return "braking"; }
  TermTraits traits() const override;
  int rows(const Horizon& horizon) const override { return horizon.N; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& horizon) const override;
  std::unique_ptr<TermScratch> make_scratch(const Horizon& horizon, int max_batch) const override;
  void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                TermScratch* scratch, TermOutput& out) const override;

 private:
  std::shared_ptr<const BodyClearance> known_;
  Options options_;
};

/// The constraint that an unknown-space policy asks for: kFree none (null), kBlocked a
/// ClearanceConstraint named "known_space" on `known` with the given d_safe, kBraking a
/// BrakingConstraint with margin d_safe and the model's deceleration.
std::shared_ptr<const Term> unknown_space_constraint(UnknownPolicy policy,
                                                     std::shared_ptr<const BodyClearance> known,
                                                     double d_safe);

}  // namespace prospect
