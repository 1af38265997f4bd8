// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/motion_model.h"

namespace prospect {

class Knobs;

/// Multirotor in its flat outputs, four degrees of freedom; the camera is fixed to the heading.
///   x = (p in R^3, v in R^3, psi) [m, m/s, rad, all in W],   u = (a in R^3, psi_dot) [m/s^2,
///   rad/s, in W].
/// Exact for constant u over dt (linear, so two half steps equal one step):
///   p' = p + v dt + a dt^2/2,   v' = v + a dt,   psi' = psi + psi_dot dt.
/// Roll and pitch are left to the attitude controller; they would follow from a + g e_z.
///
/// Limits: |ax|, |ay| <= a_max, |az| <= az_max, |psi_dot| <= omega_max bound the input; only
/// psi_dot has a rate limit, alpha_max. |(vx, vy)| <= v_max and |vz| <= vz_max bound the STATE:
/// step() does not saturate. They are the rows of state_constraints():
///   ((v_max^2 - vx^2 - vy^2)/(2 v_max),  vz_max - vz,  vz_max + vz)  [m/s],
/// the first smooth at rest and equal to the margin v_max - |(vx, vy)| to first order at the bound.
/// Source: formulation, section 1; state bounds: our choice.
class Multirotor final : public MotionModel {
 public:
  static constexpr std::string_view kName = "multirotor";

  struct Parameters {
    double v_max = 1.5;      ///< horizontal speed [m/s], > 0
    double vz_max = 0.8;     ///< vertical speed [m/s], > 0
    double a_max = 1.5;      ///< [m/s^2], > 0, along each horizontal axis of W
    double az_max = 1.0;     ///< [m/s^2], > 0
    double omega_max = 1.2;  ///< yaw rate [rad/s], > 0
    double alpha_max = 3.0;  ///< rate of the yaw rate [rad/s^2], > 0
  };

  Multirotor() : Multirotor(Parameters()) {}
  /// Throws std::invalid_argument naming the parameter, its value and what was expected.
  explicit Multirotor(const Parameters& parameters);
  const Parameters& parameters() const { return parameters_; }

  std::string_view name() const override { return kName; }
  int nx() const override { return 7; }
  int nu() const override { return 4; }
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
  int num_state_constraints() const override { return 3; }
  void state_constraints(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> values, Eigen::MatrixXd* d_x) const override;

 private:
  Parameters parameters_;
  InputLimits limits_;
};

/// The knobs (models/knobs.h): all of them.
void describe(Knobs& knobs, Multirotor::Parameters& parameters);

}  // namespace prospect
