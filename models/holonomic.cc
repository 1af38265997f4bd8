// SPDX-License-Identifier: Apache-2.0
#include "models/holonomic.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "models/braking.h"
#include "models/knobs.h"
#include "models/sinc.h"

namespace prospect {
namespace {

struct HolonomicState {
  double px, py, theta;
};
struct HolonomicInput {
  double vx, vy, omega;
};

/// One step of one candidate. Shared by step() and step_batch(), so that both agree to the bit.
inline HolonomicState advance(const HolonomicState& x, const HolonomicInput& u, double dt) {
  const double phi = 0.5 * u.omega * dt;
  const double g = dt * sinc(phi);
  const double c = std::cos(x.theta + phi), s = std::sin(x.theta + phi);
  return {x.px + g * (u.vx * c - u.vy * s), x.py + g * (u.vx * s + u.vy * c),
          x.theta + u.omega * dt};
}

}  // namespace

Holonomic::Holonomic(const Parameters& parameters) : parameters_(parameters) {
  const Parameters& p = parameters_;
  check_knobs(kName, p);
  limits_.lower = Eigen::Vector3d(p.vx_min, -p.vy_max, -p.omega_max);
  limits_.upper = Eigen::Vector3d(p.vx_max, p.vy_max, p.omega_max);
  limits_.rate = Eigen::Vector3d(p.a_max, p.a_max, p.alpha_max);
}

void Holonomic::jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                          const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                          Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const {
  assert(x.size() == 3 && u.size() == 3);
  assert(A.rows() == 3 && A.cols() == 3 && B.rows() == 3 && B.cols() == 3);
  const double vx = u[0], vy = u[1], h = 0.5 * dt, phi = u[2] * h;
  const double c = std::cos(x[2] + phi), s = std::sin(x[2] + phi);
  const double g = dt * sinc(phi);
  const double d_g = dt * h * sinc_derivative(phi);  // d g / d omega
  const double wx = vx * c - vy * s, wy = vx * s + vy * c;
  A.setIdentity();
  A(0, 2) = -g * wy;
  A(1, 2) = g * wx;
  B(0, 0) = g * c;
  B(1, 0) = g * s;
  B(2, 0) = 0.0;
  B(0, 1) = -g * s;
  B(1, 1) = g * c;
  B(2, 1) = 0.0;
  B(0, 2) = d_g * wx - g * h * wy;
  B(1, 2) = d_g * wy + g * h * wx;
  B(2, 2) = dt;
}

PoseLayout Holonomic::pose_layout() const {
  return PoseLayout{.px = 0, .py = 1, .pz = -1, .yaw = 2, .fixed_z = parameters_.fixed_z};
}

Twist Holonomic::twist(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                       const Eigen::Ref<const Eigen::VectorXd>& u) const {
  return {{u[0], u[1], 0.0}, u[2]};
}

Eigen::VectorXd Holonomic::state(const Pose& pose, const Twist& /*twist*/) const {
  return Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.yaw);
}

Eigen::VectorXd Holonomic::input(const Twist& twist) const {
  return Eigen::Vector3d(twist.linear.x(), twist.linear.y(), twist.yaw_rate);
}

Eigen::VectorXd Holonomic::braking_input(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                                         const Eigen::Ref<const Eigen::VectorXd>& previous,
                                         double dt) const {
  Eigen::VectorXd u(3);
  for (int j = 0; j < 3; ++j) {
    u[j] = brake_velocity(previous[j], limits_.rate[j], dt, limits_.lower[j], limits_.upper[j]);
  }
  return u;
}

double Holonomic::squared_speed(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                                const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                                Eigen::VectorXd* d_u) const {
  if (d_x) d_x->setZero(3);
  if (d_u) {
    d_u->setZero(3);
    (*d_u)[0] = 2.0 * u[0];
    (*d_u)[1] = 2.0 * u[1];
  }
  return u[0] * u[0] + u[1] * u[1];
}

double Holonomic::max_speed() const {
  return std::hypot(std::max(parameters_.vx_max, -parameters_.vx_min), parameters_.vy_max);
}
double Holonomic::max_yaw_rate() const { return parameters_.omega_max; }
double Holonomic::max_deceleration() const { return parameters_.a_max; }

void Holonomic::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                     const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                     Eigen::Ref<Eigen::VectorXd> next) const {
  assert(x.size() == 3 && u.size() == 3 && next.size() == 3);
  const HolonomicState end =
      advance(HolonomicState{x[0], x[1], x[2]}, HolonomicInput{u[0], u[1], u[2]}, dt);
  next << end.px, end.py, end.theta;
}

void Holonomic::step_batch(const Eigen::Ref<const BatchArray>& x,
                           const Eigen::Ref<const BatchArray>& u, double dt,
                           Eigen::Ref<BatchArray> next) const {
  assert(x.rows() == 3 && u.rows() == 3 && next.rows() == 3);
  assert(x.cols() == u.cols() && x.cols() == next.cols());
  const double* px = x.row(0).data();
  const double* py = x.row(1).data();
  const double* theta = x.row(2).data();
  const double* vx = u.row(0).data();
  const double* vy = u.row(1).data();
  const double* omega = u.row(2).data();
  double* next_px = next.row(0).data();
  double* next_py = next.row(1).data();
  double* next_theta = next.row(2).data();
  const Eigen::Index batch = x.cols();
  for (Eigen::Index b = 0; b < batch; ++b) {
    const HolonomicState end =
        advance(HolonomicState{px[b], py[b], theta[b]}, HolonomicInput{vx[b], vy[b], omega[b]}, dt);
    next_px[b] = end.px;
    next_py[b] = end.py;
    next_theta[b] = end.theta;
  }
}

void describe(Knobs& knobs, Holonomic::Parameters& p) {
  knobs.number("vx_min", p.vx_min, {-100.0, 0.0}, "m/s",
               "lowest speed forwards; less than 0: backwards");
  knobs.number("vx_max", p.vx_max, {0.001, 100.0}, "m/s", "highest speed forwards");
  knobs.number("vy_max", p.vy_max, {0.001, 100.0}, "m/s", "highest speed sideways");
  knobs.number("omega_max", p.omega_max, {0.001, 100.0}, "rad/s", "fastest turn");
  knobs.number("a_max", p.a_max, {1e-6, 1000.0}, "m/s2", "along each axis of the body");
  knobs.number("alpha_max", p.alpha_max, {0.001, 1000.0}, "rad/s2", "change of the yaw rate");
  knobs.number("fixed_z", p.fixed_z, {-1000.0, 1000.0}, "m",
               "height of the body frame's origin above the floor");
}

}  // namespace prospect
