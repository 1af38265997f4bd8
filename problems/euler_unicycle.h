// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/motion_model.h"

namespace prospect {

/// Unicycle integrated by Euler's rule, as many papers and solver examples write it:
///   x = (px, py, theta) [m, m, rad, in W],   u = (v, omega) [m/s, rad/s, in B],
///   px' = px + dt v cos(theta),   py' = py + dt v sin(theta),   theta' = theta + dt omega.
/// For problems stated with this rule; the planner's own is models/unicycle.h, which is exact.
/// Limits: 0 <= v <= v_max, |omega| <= omega_max, no limit on their rates.
class EulerUnicycle final : public MotionModel {
 public:
  EulerUnicycle(double v_max, double omega_max);

  std::string_view name() const override { return "euler_unicycle"; }
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
  PoseLayout pose_layout() const override { return {}; }
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
              const Eigen::Ref<const Eigen::VectorXd>& u) const override;
  Eigen::VectorXd state(const Pose& pose, const Twist& twist) const override;
  Eigen::VectorXd input(const Twist& twist) const override;
  /// Without a limit on rates the base stops at once.
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& previous,
                                double dt) const override;
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                       Eigen::VectorXd* d_u) const override;
  double max_speed() const override { return limits_.upper[0]; }
  double max_yaw_rate() const override { return limits_.upper[1]; }
  /// Infinite.
  double max_deceleration() const override;

 private:
  InputLimits limits_;
};

}  // namespace prospect
