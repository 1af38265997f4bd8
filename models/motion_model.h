// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>

#include "models/types.h"

namespace prospect {

/// Bounds on the input u and on its rate of change.
///   lower <= u <= upper  [unit of u],   |u_k - u_{k-1}| <= rate * dt,  rate in [unit of u / s].
/// An infinite rate means "no limit". All have nu entries.
struct InputLimits {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::VectorXd rate;
};

/// Where the pose stands in the state: pose = (x[px], x[py], pz >= 0 ? x[pz] : fixed_z, x[yaw]).
/// Every model of this project carries its pose as plain state entries, so the Jacobian of the pose
/// is a selection, and a term writes a gradient with respect to the pose straight into these rows.
struct PoseLayout {
  int px = 0;
  int py = 1;
  int pz = -1;  ///< -1: the base moves in the plane z = fixed_z
  int yaw = 2;
  double fixed_z = 0.0;  ///< [m], in W
};

/// Discrete-time motion x' = f(x, u, dt) with closed-form Jacobians.
///
/// Thread-safety: immutable after construction; all methods may be called concurrently.
/// Errors: none of these throw for finite input of the right shape; shapes are asserted.
/// Smoothness: f is C-infinity in (x, u) for every model here, including turn rates through zero.
/// Source: formulation, section 1.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  virtual std::string_view name() const = 0;
  virtual int nx() const = 0;
  virtual int nu() const = 0;

  /// next = f(x, u, dt). x, next: nx; u: nu; dt [s] > 0. `next` may not alias `x`.
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& x,
                    const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                    Eigen::Ref<Eigen::VectorXd> next) const = 0;

  /// A = df/dx (nx x nx), B = df/du (nx x nu), at (x, u, dt).
  virtual void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                         Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const = 0;

  /// The same step for a batch: x, next: nx x B; u: nu x B. The same arithmetic as step().
  virtual void step_batch(const Eigen::Ref<const BatchArray>& x,
                          const Eigen::Ref<const BatchArray>& u, double dt,
                          Eigen::Ref<BatchArray> next) const = 0;

  virtual const InputLimits& limits() const = 0;
  virtual PoseLayout pose_layout() const = 0;

  /// Body-frame velocity [m/s, rad/s] at state x while input u is applied: what the base is told.
  /// Acceleration-controlled models carry the velocity in x, so the velocity to command for the
  /// coming step is that of the state at its END, twist(x_{k+1}, u_k); at x_k it is the velocity
  /// already held.
  virtual Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
                      const Eigen::Ref<const Eigen::VectorXd>& u) const = 0;

  /// The state at rest or in motion that has this pose and this body velocity.
  /// Models without velocity in the state ignore the twist.
  virtual Eigen::VectorXd state(const Pose& pose, const Twist& twist) const = 0;

  /// The input in force that corresponds to this body velocity (velocity-controlled models), or
  /// zero (acceleration-controlled ones). Used as u_{-1} of the rate terms.
  virtual Eigen::VectorXd input(const Twist& twist) const = 0;

  /// The admissible input that brings the base to rest soonest, for one step of dt, given the input
  /// `previous` in force: within bounds and rate limits (if `previous` itself violates a bound, the
  /// bound wins over the rate). Repeating it ends at zero velocity. The way travelled is at most
  /// v^2/(2 max_deceleration()) + max_deceleration() dt^2/8 along each axis.
  virtual Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                        const Eigen::Ref<const Eigen::VectorXd>& previous,
                                        double dt) const = 0;

  /// Squared linear speed [m^2/s^2] under (x, u) and its gradient. Smooth everywhere (the speed
  /// itself is not at zero). Null pointers skip a gradient; others are resized to nx, nu.
  virtual double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                               const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                               Eigen::VectorXd* d_u) const = 0;

  /// Largest linear speed [m/s], largest yaw rate [rad/s] and guaranteed deceleration [m/s^2].
  virtual double max_speed() const = 0;
  virtual double max_yaw_rate() const = 0;
  virtual double max_deceleration() const = 0;

  /// Bounds on the state that are not bounds on the input (speeds of acceleration-controlled
  /// models), as rows c(x) >= 0 [m/s or rad/s], smooth. Velocity-controlled models have none.
  virtual int num_state_constraints() const { return 0; }
  /// values: num_state_constraints(); *d_x, if not null, becomes dc/dx (rows x nx).
  virtual void state_constraints(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                                 Eigen::Ref<Eigen::VectorXd> /*values*/,
                                 Eigen::MatrixXd* d_x) const {
    if (d_x) d_x->resize(0, nx());
  }

  /// Pose of a state, by the layout.
  Pose pose(const Eigen::Ref<const Eigen::VectorXd>& x) const {
    const PoseLayout layout = pose_layout();
    return {{x[layout.px], x[layout.py], layout.pz >= 0 ? x[layout.pz] : layout.fixed_z},
            x[layout.yaw]};
  }
};

}  // namespace prospect
