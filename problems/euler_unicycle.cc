// SPDX-License-Identifier: Apache-2.0
#include "problems/euler_unicycle.h"

#include <cmath>
#include <limits>

namespace prospect {

EulerUnicycle::EulerUnicycle(double v_max, double omega_max) {
  limits_.lower = Eigen::Vector2d(0.0, -omega_max);
  limits_.upper = Eigen::Vector2d(v_max, omega_max);
  limits_.rate = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
}

void EulerUnicycle::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                         Eigen::Ref<Eigen::VectorXd> next) const {
  next[0] = x[0] + dt * u[0] * std::cos(x[2]);
  next[1] = x[1] + dt * u[0] * std::sin(x[2]);
  next[2] = x[2] + dt * u[1];
}

void EulerUnicycle::step_batch(const Eigen::Ref<const BatchArray>& x,
                               const Eigen::Ref<const BatchArray>& u, double dt,
                               Eigen::Ref<BatchArray> next) const {
  for (Eigen::Index b = 0; b < x.cols(); ++b) {
    next(0, b) = x(0, b) + dt * u(0, b) * std::cos(x(2, b));
    next(1, b) = x(1, b) + dt * u(0, b) * std::sin(x(2, b));
    next(2, b) = x(2, b) + dt * u(1, b);
  }
}

void EulerUnicycle::jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                              const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                              Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const {
  const double c = std::cos(x[2]), s = std::sin(x[2]);
  A.setIdentity();
  A(0, 2) = -dt * u[0] * s;
  A(1, 2) = dt * u[0] * c;
  B.setZero();
  B(0, 0) = dt * c;
  B(1, 0) = dt * s;
  B(2, 1) = dt;
}

Twist EulerUnicycle::twist(const Eigen::Ref<const Eigen::VectorXd>&,
                           const Eigen::Ref<const Eigen::VectorXd>& u) const {
  return {{u[0], 0.0, 0.0}, u[1]};
}

Eigen::VectorXd EulerUnicycle::state(const Pose& pose, const Twist&) const {
  return Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.yaw);
}

Eigen::VectorXd EulerUnicycle::input(const Twist& twist) const {
  return Eigen::Vector2d(twist.linear.x(), twist.yaw_rate);
}

Eigen::VectorXd EulerUnicycle::braking_input(const Eigen::Ref<const Eigen::VectorXd>&,
                                             const Eigen::Ref<const Eigen::VectorXd>&,
                                             double) const {
  return Eigen::Vector2d::Zero();
}

double EulerUnicycle::squared_speed(const Eigen::Ref<const Eigen::VectorXd>&,
                                    const Eigen::Ref<const Eigen::VectorXd>& u,
                                    Eigen::VectorXd* d_x, Eigen::VectorXd* d_u) const {
  if (d_x) d_x->setZero(3);
  if (d_u) *d_u = Eigen::Vector2d(2.0 * u[0], 0.0);
  return u[0] * u[0];
}

double EulerUnicycle::max_deceleration() const { return std::numeric_limits<double>::infinity(); }

}  // namespace prospect
