// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/motion_model.h"
#include "models/unicycle.h"

namespace prospect {

class Knobs;

/// Acceleration-controlled base that cannot move sideways: what a real base tracks.
///   x = (px, py, theta, v, omega) [m, m, rad, m/s, rad/s],   u = (a, alpha) [m/s^2, rad/s^2].
/// Constant u over dt makes v, omega and theta exact:
///   v' = v + a dt,   omega' = omega + alpha dt,   theta' = theta + omega dt + alpha dt^2/2.
/// The position is then a Fresnel integral, without closed form. Our choice: the arc of mean speed
/// and mean turn rate, v_m = v + a dt/2, omega_m = omega + alpha dt/2, phi = omega_m dt/2, plus the
/// leading term of what the arc misses, which is purely lateral:
///   p' = p + R(theta + phi) (v_m dt sinc(phi),  (a omega - v alpha) dt^3/12).
/// Local position error O(dt^5) (the arc alone: O(dt^3)); exact for alpha = 0, a = 0 and for
/// straight lines; C-infinity through omega = 0. Two half steps equal one step up to that error,
/// which is below 0.05 mm for the default limits and dt <= 0.25 s.
///
/// Limits: |a| <= a_max and |alpha| <= alpha_max bound the input. v_min <= v <= v_max and
/// |omega| <= omega_max bound the STATE: step() does not saturate, as that would break smoothness.
/// They are the rows of state_constraints(): (v_max - v, v - v_min, omega_max - omega,
/// omega_max + omega). The rates of a and alpha (jerk) are not limited.
/// Source: formulation, section 1; position update and state bounds: our choice.
class UnicycleAccel final : public MotionModel {
 public:
  static constexpr std::string_view kName = "unicycle_accel";

  using Parameters = Unicycle::Parameters;

  UnicycleAccel() : UnicycleAccel(Parameters()) {}
  /// Throws std::invalid_argument naming the parameter, its value and what was expected.
  explicit UnicycleAccel(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  std::string_view name() const override { return kName; }
  int nx() const override { return 5; }
  int nu() const override { return 2; }
  void step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& u,
            double dt, Eigen::Ref<Eigen::VectorXd> next) const override;
  void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                 Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const override;
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>& u,
                  double dt, Eigen::Ref<BatchArray> next) const override;
  const InputLimits& limits() const override { return limits_; }
  PoseLayout pose_layout() const override;
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
              const Eigen::Ref<const Eigen::VectorXd>& u) const override;
  Eigen::VectorXd state(const Pose& pose, const Twist& twist) const override;
  Eigen::VectorXd input(const Twist& twist) const override;
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& previous,
                                double dt) const override;
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                       Eigen::VectorXd* d_u) const override;
  double max_speed() const override;
  double max_yaw_rate() const override;
  double max_deceleration() const override;
  int num_state_constraints() const override { return 4; }
  void state_constraints(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> values, Eigen::MatrixXd* d_x) const override;

 private:
  Parameters parameters_;
  InputLimits limits_;
};

}  // namespace prospect
