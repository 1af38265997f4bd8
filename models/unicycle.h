// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/motion_model.h"

namespace prospect {

class Knobs;

/// Velocity-controlled base that cannot move sideways.
///   x = (px, py, theta) [m, m, rad, in W],   u = (v, omega) [m/s, rad/s, in B].
/// Exact integration of constant u over dt (a circular arc), phi = omega dt / 2:
///   p' = p + v dt sinc(phi) (cos(theta + phi), sin(theta + phi)),   theta' = theta + omega dt.
/// Two half steps equal one step. Written with sinc, so it is C-infinity through omega = 0.
/// The yaw is not wrapped.
/// Limits: v_min <= v <= v_max, |omega| <= omega_max, |dv| <= a_max dt, |domega| <= alpha_max dt.
/// Source: formulation, section 1.
class Unicycle final : public MotionModel {
 public:
  static constexpr std::string_view kName = "unicycle";

  struct Parameters {
    double v_min = 0.0;      ///< [m/s], <= 0; negative: may reverse
    double v_max = 0.6;      ///< [m/s], > 0
    double omega_max = 1.0;  ///< [rad/s], > 0
    double a_max = 0.8;      ///< [m/s^2], > 0, for speeding up and braking
    double alpha_max = 2.5;  ///< [rad/s^2], > 0
    double fixed_z = 0.0;    ///< height of B's origin in W [m]
  };

  Unicycle() : Unicycle(Parameters()) {}
  /// Throws std::invalid_argument naming the parameter, its value and what was expected.
  explicit Unicycle(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  std::string_view name() const override { return kName; }
  int nx() const override { return 3; }
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

 private:
  Parameters parameters_;
  InputLimits limits_;
};

/// The knobs (models/knobs.h): all of them.
void describe(Knobs& knobs, Unicycle::Parameters& parameters);

}  // namespace prospect
