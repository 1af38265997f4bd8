// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/motion_model.h"

namespace prospect {

/// One or several quadrotors as rigid bodies, integrated by Euler's rule. For problems stated with
/// this rule (problems/quadrotors.h). Of each, with z down:
///   x = (p in R^3 [m, in W], q = (q0, q1, q2, q3), v in R^3 [m/s, in W], w in R^3 [rad/s, in B]),
///   u = four speeds of rotors [rad/s],   t_i = kT u_i^2,   T = sum_i t_i,   c_i = kQ u_i^2
///   p' = v,   q' = 1/2 q (0, w),   |.| by axis:
///   v' = (-Cd |v| v - T (2 (q0 q2 + q1 q3), 2 (q2 q3 - q0 q1), q0^2 - q1^2 - q2^2 + q3^2))/m + g
///   wx' = ((Iy - Iz) wy wz - Ir (u0 - u1 + u2 - u3) wy + d (t0 - t1 - t2 + t3))/Ix
///   wy' = ((Iz - Ix) wx wz + Ir (u0 - u1 + u2 - u3) wx + d (t0 + t1 - t2 - t3))/Iy
///   wz' = ((Ix - Iy) wx wy - c0 + c1 - c2 + c3)/Iz
/// q is not normalised. State and input are those of the first, then of the second, ...: 13 and 4
/// entries each. Bounds: 75 <= u_i <= 925, no limit on their rates. C1: |v| v has a second
/// derivative that jumps at 0.
///
/// What a model tells of a base beside its dynamics (pose, twist, speed) is of the first one. Its
/// heading is no entry of the state: no term that asks for one can be used. Nothing brakes it.
/// Source: Viljoen, "jaxipm" (arXiv 2606.26341).
class EulerQuadrotors final : public MotionModel {
 public:
  static constexpr int kStates = 13, kInputs = 4;
  /// [rad/s] of all rotors, at which a level quadrotor neither rises nor falls.
  static double hover();

  explicit EulerQuadrotors(int count);

  std::string_view name() const override { return "euler_quadrotors"; }
  int nx() const override { return kStates * count_; }
  int nu() const override { return kInputs * count_; }
  void step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& u,
            double dt, Eigen::Ref<Eigen::VectorXd> next) const override;
  void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                 Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const override;
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>& u,
                  double dt, Eigen::Ref<BatchArray> next) const override;
  const InputLimits& limits() const override { return limits_; }
  PoseLayout pose_layout() const override { return {0, 1, 2, 6, 0.0}; }
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>& x,
              const Eigen::Ref<const Eigen::VectorXd>& u) const override;
  /// All of them level, there, with that velocity.
  Eigen::VectorXd state(const Pose& pose, const Twist& twist) const override;
  Eigen::VectorXd input(const Twist& twist) const override;  ///< hover()
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& previous,
                                double dt) const override;  ///< hover()
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                       Eigen::VectorXd* d_u) const override;
  double max_speed() const override;     ///< infinite
  double max_yaw_rate() const override;  ///< infinite
  double max_deceleration() const override { return 0.0; }

 private:
  int count_;
  InputLimits limits_;
};

}  // namespace prospect
