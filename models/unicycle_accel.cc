// SPDX-License-Identifier: Apache-2.0
#include "models/unicycle_accel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "models/braking.h"
#include "models/knobs.h"
#include "models/sinc.h"

namespace prospect {
namespace {

struct UnicycleAccelState {
  double px, py, theta, v, omega;
};
struct UnicycleAccelInput {
  double a, alpha;
};

/// One step of one candidate. Shared by step() and step_batch(), so that both agree to the bit.
inline UnicycleAccelState advance(const UnicycleAccelState& x, const UnicycleAccelInput& u,
                                  double dt) {
  const double h = 0.5 * dt;
  const double v_m = x.v + u.a * h;
  const double omega_m = x.omega + u.alpha * h;
  const double phi = omega_m * h;
  const double forward = v_m * dt * sinc(phi);
  const double lateral = (u.a * x.omega - x.v * u.alpha) * (dt * dt * dt / 12.0);
  const double c = std::cos(x.theta + phi), s = std::sin(x.theta + phi);
  return {x.px + (forward * c - lateral * s), x.py + (forward * s + lateral * c),
          x.theta + omega_m * dt, x.v + u.a * dt, x.omega + u.alpha * dt};
}

}  // namespace

UnicycleAccel::UnicycleAccel(const Parameters& parameters) : parameters_(parameters) {
  const Parameters& p = parameters_;
  check_knobs(kName, p);
  limits_.lower = Eigen::Vector2d(-p.a_max, -p.alpha_max);
  limits_.upper = Eigen::Vector2d(p.a_max, p.alpha_max);
  limits_.rate.setConstant(2, std::numeric_limits<double>::infinity());
}

void UnicycleAccel::jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                              const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                              Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const {
  assert(x.size() == 5 && u.size() == 2);
  assert(A.rows() == 5 && A.cols() == 5 && B.rows() == 5 && B.cols() == 2);
  const double v = x[3], omega = x[4], a = u[0], alpha = u[1];
  const double h = 0.5 * dt, third = dt * dt * dt / 12.0;
  const double v_m = v + a * h, omega_m = omega + alpha * h, phi = omega_m * h;
  const double c = std::cos(x[2] + phi), s = std::sin(x[2] + phi);
  const double d_v = dt * sinc(phi);                           // d forward / d v
  const double d_omega = v_m * dt * h * sinc_derivative(phi);  // d forward / d omega
  const double forward = v_m * d_v;
  const double lateral = (a * omega - v * alpha) * third;
  // d p' = R(theta + phi) [(d forward, d lateral) + d(theta + phi) (-lateral, forward)].
  const auto turned = [&](double d_forward, double d_lateral, double d_angle) {
    const double f = d_forward - d_angle * lateral;
    const double l = d_lateral + d_angle * forward;
    return Eigen::Vector2d(c * f - s * l, s * f + c * l);
  };
  A.setIdentity();
  A.block<2, 1>(0, 2) = turned(0.0, 0.0, 1.0);
  A.block<2, 1>(0, 3) = turned(d_v, -alpha * third, 0.0);
  A.block<2, 1>(0, 4) = turned(d_omega, a * third, h);
  A(2, 4) = dt;
  B.setZero();
  B.block<2, 1>(0, 0) = turned(d_v * h, omega * third, 0.0);
  B.block<2, 1>(0, 1) = turned(d_omega * h, -v * third, h * h);
  B(2, 1) = h * dt;
  B(3, 0) = dt;
  B(4, 1) = dt;
}

PoseLayout UnicycleAccel::pose_layout() const {
  return PoseLayout{.px = 0, .py = 1, .pz = -1, .yaw = 2, .fixed_z = parameters_.fixed_z};
}

Twist UnicycleAccel::twist(const Eigen::Ref<const Eigen::VectorXd>& x,
                           const Eigen::Ref<const Eigen::VectorXd>& /*u*/) const {
  return {{x[3], 0.0, 0.0}, x[4]};
}

Eigen::VectorXd UnicycleAccel::state(const Pose& pose, const Twist& twist) const {
  Eigen::VectorXd x(5);
  x << pose.position.x(), pose.position.y(), pose.yaw, twist.linear.x(), twist.yaw_rate;
  return x;
}

Eigen::VectorXd UnicycleAccel::input(const Twist& /*twist*/) const {
  return Eigen::Vector2d::Zero();
}

Eigen::VectorXd UnicycleAccel::braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                             const Eigen::Ref<const Eigen::VectorXd>& /*previous*/,
                                             double dt) const {
  Eigen::VectorXd u(2);
  u[0] = brake_acceleration(x[3], dt, limits_.lower[0], limits_.upper[0]);
  u[1] = brake_acceleration(x[4], dt, limits_.lower[1], limits_.upper[1]);
  return u;
}

double UnicycleAccel::squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                                    const Eigen::Ref<const Eigen::VectorXd>& /*u*/,
                                    Eigen::VectorXd* d_x, Eigen::VectorXd* d_u) const {
  if (d_x) {
    d_x->setZero(5);
    (*d_x)[3] = 2.0 * x[3];
  }
  if (d_u) d_u->setZero(2);
  return x[3] * x[3];
}

double UnicycleAccel::max_speed() const { return std::max(parameters_.v_max, -parameters_.v_min); }
double UnicycleAccel::max_yaw_rate() const { return parameters_.omega_max; }
double UnicycleAccel::max_deceleration() const { return parameters_.a_max; }

void UnicycleAccel::state_constraints(const Eigen::Ref<const Eigen::VectorXd>& x,
                                      Eigen::Ref<Eigen::VectorXd> values,
                                      Eigen::MatrixXd* d_x) const {
  assert(x.size() == 5 && values.size() == 4);
  values[0] = parameters_.v_max - x[3];
  values[1] = x[3] - parameters_.v_min;
  values[2] = parameters_.omega_max - x[4];
  values[3] = parameters_.omega_max + x[4];
  if (d_x) {
    d_x->setZero(4, 5);
    (*d_x)(0, 3) = -1.0;
    (*d_x)(1, 3) = 1.0;
    (*d_x)(2, 4) = -1.0;
    (*d_x)(3, 4) = 1.0;
  }
}

void UnicycleAccel::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                         Eigen::Ref<Eigen::VectorXd> next) const {
  assert(x.size() == 5 && u.size() == 2 && next.size() == 5);
  const UnicycleAccelState end =
      advance(UnicycleAccelState{x[0], x[1], x[2], x[3], x[4]}, UnicycleAccelInput{u[0], u[1]}, dt);
  next << end.px, end.py, end.theta, end.v, end.omega;
}

void UnicycleAccel::step_batch(const Eigen::Ref<const BatchArray>& x,
                               const Eigen::Ref<const BatchArray>& u, double dt,
                               Eigen::Ref<BatchArray> next) const {
  assert(x.rows() == 5 && u.rows() == 2 && next.rows() == 5);
  assert(x.cols() == u.cols() && x.cols() == next.cols());
  const double* px = x.row(0).data();
  const double* py = x.row(1).data();
  const double* theta = x.row(2).data();
  const double* v = x.row(3).data();
  const double* omega = x.row(4).data();
  const double* a = u.row(0).data();
  const double* alpha = u.row(1).data();
  double* next_px = next.row(0).data();
  double* next_py = next.row(1).data();
  double* next_theta = next.row(2).data();
  double* next_v = next.row(3).data();
  double* next_omega = next.row(4).data();
  const Eigen::Index batch = x.cols();
  for (Eigen::Index b = 0; b < batch; ++b) {
    const UnicycleAccelState end =
        advance(UnicycleAccelState{px[b], py[b], theta[b], v[b], omega[b]},
                UnicycleAccelInput{a[b], alpha[b]}, dt);
    next_px[b] = end.px;
    next_py[b] = end.py;
    next_theta[b] = end.theta;
    next_v[b] = end.v;
    next_omega[b] = end.omega;
  }
}

}  // namespace prospect
