// SPDX-License-Identifier: Apache-2.0
#include "models/unicycle.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "models/braking.h"
#include "models/knobs.h"
#include "models/sinc.h"

namespace prospect {
namespace {

struct UnicycleState {
  double px, py, theta;
};
struct UnicycleInput {
  double v, omega;
};

/// One step of one candidate. Shared by step() and step_batch(), so that both agree to the bit.
inline UnicycleState advance(const UnicycleState& x, const UnicycleInput& u, double dt) {
  const double phi = 0.5 * u.omega * dt;
  const double chord = u.v * dt * sinc(phi);
  return {x.px + chord * std::cos(x.theta + phi), x.py + chord * std::sin(x.theta + phi),
          x.theta + u.omega * dt};
}

}  // namespace

Unicycle::Unicycle(const Parameters& parameters) : parameters_(parameters) {
  const Parameters& p = parameters_;
  check_knobs(kName, p);
  limits_.lower = Eigen::Vector2d(p.v_min, -p.omega_max);
  limits_.upper = Eigen::Vector2d(p.v_max, p.omega_max);
  limits_.rate = Eigen::Vector2d(p.a_max, p.alpha_max);
}

void Unicycle::jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                         Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const {
  assert(x.size() == 3 && u.size() == 2);
  assert(A.rows() == 3 && A.cols() == 3 && B.rows() == 3 && B.cols() == 2);
  const double v = u[0], h = 0.5 * dt, phi = u[1] * h;
  const double c = std::cos(x[2] + phi), s = std::sin(x[2] + phi);
  const double d_v = dt * sinc(phi);                         // d chord / d v
  const double d_omega = v * dt * h * sinc_derivative(phi);  // d chord / d omega
  const double chord = v * d_v;
  A.setIdentity();
  A(0, 2) = -chord * s;
  A(1, 2) = chord * c;
  B(0, 0) = d_v * c;
  B(1, 0) = d_v * s;
  B(2, 0) = 0.0;
  B(0, 1) = d_omega * c - chord * h * s;
  B(1, 1) = d_omega * s + chord * h * c;
  B(2, 1) = dt;
}

PoseLayout Unicycle::pose_layout() const {
  return PoseLayout{.px = 0, .py = 1, .pz = -1, .yaw = 2, .fixed_z = parameters_.fixed_z};
}

Twist Unicycle::twist(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                      const Eigen::Ref<const Eigen::VectorXd>& u) const {
  return {{u[0], 0.0, 0.0}, u[1]};
}

Eigen::VectorXd Unicycle::state(const Pose& pose, const Twist& /*twist*/) const {
  return Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.yaw);
}

Eigen::VectorXd Unicycle::input(const Twist& twist) const {
  return Eigen::Vector2d(twist.linear.x(), twist.yaw_rate);
}

Eigen::VectorXd Unicycle::braking_input(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                                        const Eigen::Ref<const Eigen::VectorXd>& previous,
                                        double dt) const {
  Eigen::VectorXd u(2);
  for (int j = 0; j < 2; ++j) {
    u[j] = brake_velocity(previous[j], limits_.rate[j], dt, limits_.lower[j], limits_.upper[j]);
  }
  return u;
}

double Unicycle::squared_speed(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                               const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_x,
                               Eigen::VectorXd* d_u) const {
  if (d_x) d_x->setZero(3);
  if (d_u) {
    d_u->setZero(2);
    (*d_u)[0] = 2.0 * u[0];
  }
  return u[0] * u[0];
}

double Unicycle::max_speed() const { return std::max(parameters_.v_max, -parameters_.v_min); }
double Unicycle::max_yaw_rate() const { return parameters_.omega_max; }
double Unicycle::max_deceleration() const { return parameters_.a_max; }

void Unicycle::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                    const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                    Eigen::Ref<Eigen::VectorXd> next) const {
  assert(x.size() == 3 && u.size() == 2 && next.size() == 3);
  const UnicycleState end = advance(UnicycleState{x[0], x[1], x[2]}, UnicycleInput{u[0], u[1]}, dt);
  next << end.px, end.py, end.theta;
}

void Unicycle::step_batch(const Eigen::Ref<const BatchArray>& x,
                          const Eigen::Ref<const BatchArray>& u, double dt,
                          Eigen::Ref<BatchArray> next) const {
  assert(x.rows() == 3 && u.rows() == 2 && next.rows() == 3);
  assert(x.cols() == u.cols() && x.cols() == next.cols());
  const double* px = x.row(0).data();
  const double* py = x.row(1).data();
  const double* theta = x.row(2).data();
  const double* v = u.row(0).data();
  const double* omega = u.row(1).data();
  double* next_px = next.row(0).data();
  double* next_py = next.row(1).data();
  double* next_theta = next.row(2).data();
  const Eigen::Index batch = x.cols();
  for (Eigen::Index b = 0; b < batch; ++b) {
    const UnicycleState end =
        advance(UnicycleState{px[b], py[b], theta[b]}, UnicycleInput{v[b], omega[b]}, dt);
    next_px[b] = end.px;
    next_py[b] = end.py;
    next_theta[b] = end.theta;
  }
}

void describe(Knobs& knobs, Unicycle::Parameters& p) {
  knobs.number("v_min", p.v_min, {-100.0, 0.0}, "m/s", "lowest speed; less than 0: it may reverse");
  knobs.number("v_max", p.v_max, {0.001, 100.0}, "m/s", "highest speed");
  knobs.number("omega_max", p.omega_max, {0.001, 100.0}, "rad/s", "fastest turn");
  knobs.number("a_max", p.a_max, {1e-6, 1000.0}, "m/s2", "for speeding up and braking");
  knobs.number("alpha_max", p.alpha_max, {0.001, 1000.0}, "rad/s2", "change of the yaw rate");
  knobs.number("fixed_z", p.fixed_z, {-1000.0, 1000.0}, "m",
               "height of the body frame's origin above the floor");
}

}  // namespace prospect
