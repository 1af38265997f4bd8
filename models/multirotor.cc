// SPDX-License-Identifier: Apache-2.0
#include "models/multirotor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "models/braking.h"
#include "models/knobs.h"

namespace prospect {
namespace {

struct MultirotorState {
  double px, py, pz, vx, vy, vz, psi;
};
struct MultirotorInput {
  double ax, ay, az, psi_dot;
};

/// One step of one candidate. Shared by step() and step_batch(), so that both agree to the bit.
inline MultirotorState advance(const MultirotorState& x, const MultirotorInput& u, double dt) {
  const double half_square = 0.5 * dt * dt;
  return {x.px + (x.vx * dt + u.ax * half_square),
          x.py + (x.vy * dt + u.ay * half_square),
          x.pz + (x.vz * dt + u.az * half_square),
          x.vx + u.ax * dt,
          x.vy + u.ay * dt,
          x.vz + u.az * dt,
          x.psi + u.psi_dot * dt};
}

}  // namespace

Multirotor::Multirotor(const Parameters& parameters) : parameters_(parameters) {
  const Parameters& p = parameters_;
  check_knobs(kName, p);
  const double infinity = std::numeric_limits<double>::infinity();
  limits_.upper = Eigen::Vector4d(p.a_max, p.a_max, p.az_max, p.omega_max);
  limits_.lower = -limits_.upper;
  limits_.rate = Eigen::Vector4d(infinity, infinity, infinity, p.alpha_max);
}

void Multirotor::jacobians(const Eigen::Ref<const Eigen::VectorXd>& /*x*/,
                           const Eigen::Ref<const Eigen::VectorXd>& /*u*/, double dt,
                           Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const {
  assert(A.rows() == 7 && A.cols() == 7 && B.rows() == 7 && B.cols() == 4);
  A.setIdentity();
  B.setZero();
  for (int i = 0; i < 3; ++i) {
    A(i, 3 + i) = dt;
    B(i, i) = 0.5 * dt * dt;
    B(3 + i, i) = dt;
  }
  B(6, 3) = dt;
}

PoseLayout Multirotor::pose_layout() const {
  return PoseLayout{.px = 0, .py = 1, .pz = 2, .yaw = 6, .fixed_z = 0.0};
}

Twist Multirotor::twist(const Eigen::Ref<const Eigen::VectorXd>& x,
                        const Eigen::Ref<const Eigen::VectorXd>& u) const {
  const double c = std::cos(x[6]), s = std::sin(x[6]);
  return {{c * x[3] + s * x[4], -s * x[3] + c * x[4], x[5]}, u[3]};
}

Eigen::VectorXd Multirotor::state(const Pose& pose, const Twist& twist) const {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const Eigen::Vector3d& v = twist.linear;
  Eigen::VectorXd x(7);
  x << pose.position, c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z(), pose.yaw;
  return x;
}

Eigen::VectorXd Multirotor::input(const Twist& twist) const {
  return Eigen::Vector4d(0.0, 0.0, 0.0, twist.yaw_rate);
}

Eigen::VectorXd Multirotor::braking_input(const Eigen::Ref<const Eigen::VectorXd>& x,
                                          const Eigen::Ref<const Eigen::VectorXd>& previous,
                                          double dt) const {
  Eigen::VectorXd u(4);
  for (int i = 0; i < 3; ++i) {
    u[i] = brake_acceleration(x[3 + i], dt, limits_.lower[i], limits_.upper[i]);
  }
  u[3] = brake_velocity(previous[3], limits_.rate[3], dt, limits_.lower[3], limits_.upper[3]);
  return u;
}

double Multirotor::squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                                 const Eigen::Ref<const Eigen::VectorXd>& /*u*/,
                                 Eigen::VectorXd* d_x, Eigen::VectorXd* d_u) const {
  if (d_x) {
    d_x->setZero(7);
    d_x->segment<3>(3) = 2.0 * x.segment<3>(3);
  }
  if (d_u) d_u->setZero(4);
  return x.segment<3>(3).squaredNorm();
}

double Multirotor::max_speed() const { return std::hypot(parameters_.v_max, parameters_.vz_max); }
double Multirotor::max_yaw_rate() const { return parameters_.omega_max; }
double Multirotor::max_deceleration() const {
  return std::min(parameters_.a_max, parameters_.az_max);
}

void Multirotor::state_constraints(const Eigen::Ref<const Eigen::VectorXd>& x,
                                   Eigen::Ref<Eigen::VectorXd> values, Eigen::MatrixXd* d_x) const {
  assert(x.size() == 7 && values.size() == 3);
  const double v_max = parameters_.v_max;
  values[0] = (v_max * v_max - x[3] * x[3] - x[4] * x[4]) / (2.0 * v_max);
  values[1] = parameters_.vz_max - x[5];
  values[2] = parameters_.vz_max + x[5];
  if (d_x) {
    d_x->setZero(3, 7);
    (*d_x)(0, 3) = -x[3] / v_max;
    (*d_x)(0, 4) = -x[4] / v_max;
    (*d_x)(1, 5) = -1.0;
    (*d_x)(2, 5) = 1.0;
  }
}

void Multirotor::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                      const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                      Eigen::Ref<Eigen::VectorXd> next) const {
  assert(x.size() == 7 && u.size() == 4 && next.size() == 7);
  const MultirotorState end = advance(MultirotorState{x[0], x[1], x[2], x[3], x[4], x[5], x[6]},
                                      MultirotorInput{u[0], u[1], u[2], u[3]}, dt);
  next << end.px, end.py, end.pz, end.vx, end.vy, end.vz, end.psi;
}

void Multirotor::step_batch(const Eigen::Ref<const BatchArray>& x,
                            const Eigen::Ref<const BatchArray>& u, double dt,
                            Eigen::Ref<BatchArray> next) const {
  assert(x.rows() == 7 && u.rows() == 4 && next.rows() == 7);
  assert(x.cols() == u.cols() && x.cols() == next.cols());
  const double* px = x.row(0).data();
  const double* py = x.row(1).data();
  const double* pz = x.row(2).data();
  const double* vx = x.row(3).data();
  const double* vy = x.row(4).data();
  const double* vz = x.row(5).data();
  const double* psi = x.row(6).data();
  const double* ax = u.row(0).data();
  const double* ay = u.row(1).data();
  const double* az = u.row(2).data();
  const double* psi_dot = u.row(3).data();
  double* next_px = next.row(0).data();
  double* next_py = next.row(1).data();
  double* next_pz = next.row(2).data();
  double* next_vx = next.row(3).data();
  double* next_vy = next.row(4).data();
  double* next_vz = next.row(5).data();
  double* next_psi = next.row(6).data();
  const Eigen::Index batch = x.cols();
  for (Eigen::Index b = 0; b < batch; ++b) {
    const MultirotorState end =
        advance(MultirotorState{px[b], py[b], pz[b], vx[b], vy[b], vz[b], psi[b]},
                MultirotorInput{ax[b], ay[b], az[b], psi_dot[b]}, dt);
    next_px[b] = end.px;
    next_py[b] = end.py;
    next_pz[b] = end.pz;
    next_vx[b] = end.vx;
    next_vy[b] = end.vy;
    next_vz[b] = end.vz;
    next_psi[b] = end.psi;
  }
}

void describe(Knobs& knobs, Multirotor::Parameters& p) {
  knobs.number("v_max", p.v_max, {0.001, 100.0}, "m/s", "highest horizontal speed");
  knobs.number("vz_max", p.vz_max, {0.001, 100.0}, "m/s", "highest vertical speed");
  knobs.number("a_max", p.a_max, {1e-6, 1000.0}, "m/s2", "along each horizontal axis");
  knobs.number("az_max", p.az_max, {1e-6, 1000.0}, "m/s2", "along the vertical");
  knobs.number("omega_max", p.omega_max, {0.001, 100.0}, "rad/s", "fastest turn");
  knobs.number("alpha_max", p.alpha_max, {0.001, 1000.0}, "rad/s2", "change of the yaw rate");
}

}  // namespace prospect
