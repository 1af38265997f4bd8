// SPDX-License-Identifier: Apache-2.0
#include "problems/euler_quadrotors.h"

#include <cmath>
#include <limits>

namespace prospect {
namespace {

constexpr double kMass = 1.2, kArm = 0.16, kIx = 0.0123, kIy = 0.0123, kIz = 0.0224;
constexpr double kRotor = 2.7e-5, kDrag = 0.1, kThrust = 1.076e-5, kTorque = 1.632e-7;
constexpr double kGravity = 9.81;
// Of the rotors: which way they turn, and on which side of the axes of the body they are.
constexpr double kTurn[] = {1, -1, 1, -1}, kRoll[] = {1, -1, -1, 1}, kPitch[] = {1, 1, -1, -1};

using State = Eigen::Matrix<double, EulerQuadrotors::kStates, 1>;
using Input = Eigen::Matrix<double, EulerQuadrotors::kInputs, 1>;

struct Rotors {
  double thrust = 0.0, spin = 0.0;            // sum t_i, sum of speeds with their signs
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  // [N m]
};
Rotors rotors(const Input& u) {
  Rotors all;
  for (int i = 0; i < EulerQuadrotors::kInputs; ++i) {
    const double square = u[i] * u[i];
    all.thrust += kThrust * square;
    all.spin += kTurn[i] * u[i];
    all.roll += kArm * kThrust * kRoll[i] * square;
    all.pitch += kArm * kThrust * kPitch[i] * square;
    all.yaw -= kTorque * kTurn[i] * square;
  }
  return all;
}

/// Where the rotors push, times -1: the third axis of the body if q has length 1.
Eigen::Vector3d axis(const State& x) {
  return {2.0 * (x[3] * x[5] + x[4] * x[6]), 2.0 * (x[5] * x[6] - x[3] * x[4]),
          x[3] * x[3] - x[4] * x[4] - x[5] * x[5] + x[6] * x[6]};
}

State derivative(const State& x, const Input& u) {
  const Rotors all = rotors(u);
  const double p = x[10], q = x[11], r = x[12];
  const Eigen::Vector3d v = x.segment<3>(7), down = axis(x);
  State d;
  d.head<3>() = v;
  d[3] = -0.5 * (p * x[4] + q * x[5] + r * x[6]);
  d[4] = 0.5 * (p * x[3] - q * x[6] + r * x[5]);
  d[5] = 0.5 * (p * x[6] + q * x[3] - r * x[4]);
  d[6] = 0.5 * (-p * x[5] + q * x[4] + r * x[3]);
  d.segment<3>(7) = (-kDrag * v.cwiseAbs().cwiseProduct(v) - all.thrust * down) / kMass;
  d[9] += kGravity;
  d[10] = ((kIy - kIz) * q * r - kRotor * all.spin * q + all.roll) / kIx;
  d[11] = ((kIz - kIx) * p * r + kRotor * all.spin * p + all.pitch) / kIy;
  d[12] = ((kIx - kIy) * p * q + all.yaw) / kIz;
  return d;
}

/// Derivatives of derivative() by x and u, into matrices that are zero.
template <typename A, typename B>
void differentiate(const State& x, const Input& u, A&& by_x, B&& by_u) {
  const Rotors all = rotors(u);
  const double p = x[10], q = x[11], r = x[12];
  by_x.template block<3, 3>(0, 7).setIdentity();
  by_x.template block<4, 4>(3, 3) << 0, -p, -q, -r, p, 0, r, -q, q, -r, 0, p, r, q, -p, 0;
  by_x.template block<4, 4>(3, 3) *= 0.5;
  by_x.template block<4, 3>(3, 10) << -x[4], -x[5], -x[6], x[3], -x[6], x[5], x[6], x[3], -x[4],
      -x[5], x[4], x[3];
  by_x.template block<4, 3>(3, 10) *= 0.5;
  by_x.template block<3, 4>(7, 3) << x[5], x[6], x[3], x[4], -x[4], -x[3], x[6], x[5], x[3], -x[4],
      -x[5], x[6];
  by_x.template block<3, 4>(7, 3) *= -2.0 * all.thrust / kMass;
  for (int i = 7; i < 10; ++i) by_x(i, i) = -2.0 * kDrag * std::abs(x[i]) / kMass;
  by_x.template block<3, 3>(10, 10) << 0, ((kIy - kIz) * r - kRotor * all.spin) / kIx,
      (kIy - kIz) * q / kIx, ((kIz - kIx) * r + kRotor * all.spin) / kIy, 0, (kIz - kIx) * p / kIy,
      (kIx - kIy) * q / kIz, (kIx - kIy) * p / kIz, 0;
  const Eigen::Vector3d down = axis(x);
  for (int i = 0; i < EulerQuadrotors::kInputs; ++i) {
    const double slope = 2.0 * kThrust * u[i];
    by_u.template block<3, 1>(7, i) = -slope / kMass * down;
    by_u(10, i) = (-kRotor * kTurn[i] * q + kArm * kRoll[i] * slope) / kIx;
    by_u(11, i) = (kRotor * kTurn[i] * p + kArm * kPitch[i] * slope) / kIy;
    by_u(12, i) = -2.0 * kTorque * kTurn[i] * u[i] / kIz;
  }
}

}  // namespace

double EulerQuadrotors::hover() { return std::sqrt(kMass * kGravity / (kInputs * kThrust)); }

EulerQuadrotors::EulerQuadrotors(int count) : count_(count) {
  limits_.lower = Eigen::VectorXd::Constant(nu(), 75.0);
  limits_.upper = Eigen::VectorXd::Constant(nu(), 925.0);
  limits_.rate = Eigen::VectorXd::Constant(nu(), std::numeric_limits<double>::infinity());
}

void EulerQuadrotors::step(const Eigen::Ref<const Eigen::VectorXd>& x,
                           const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                           Eigen::Ref<Eigen::VectorXd> next) const {
  for (int i = 0; i < count_; ++i) {
    const State one = x.segment<kStates>(kStates * i);
    next.segment<kStates>(kStates * i) =
        one + dt * derivative(one, u.segment<kInputs>(kInputs * i));
  }
}

void EulerQuadrotors::step_batch(const Eigen::Ref<const BatchArray>& x,
                                 const Eigen::Ref<const BatchArray>& u, double dt,
                                 Eigen::Ref<BatchArray> next) const {
  for (Eigen::Index b = 0; b < x.cols(); ++b) {
    for (int i = 0; i < count_; ++i) {
      const State one = x.col(b).segment<kStates>(kStates * i).matrix();
      const Input speeds = u.col(b).segment<kInputs>(kInputs * i).matrix();
      next.col(b).segment<kStates>(kStates * i) = (one + dt * derivative(one, speeds)).array();
    }
  }
}

void EulerQuadrotors::jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                                const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                                Eigen::Ref<Eigen::MatrixXd> A,
                                Eigen::Ref<Eigen::MatrixXd> B) const {
  A.setZero();
  B.setZero();
  for (int i = 0; i < count_; ++i) {
    differentiate(x.segment<kStates>(kStates * i), u.segment<kInputs>(kInputs * i),
                  A.block<kStates, kStates>(kStates * i, kStates * i),
                  B.block<kStates, kInputs>(kStates * i, kInputs * i));
  }
  A *= dt;
  B *= dt;
  A.diagonal().array() += 1.0;
}

Twist EulerQuadrotors::twist(const Eigen::Ref<const Eigen::VectorXd>& x,
                             const Eigen::Ref<const Eigen::VectorXd>&) const {
  return {x.segment<3>(7), x[12]};
}

Eigen::VectorXd EulerQuadrotors::state(const Pose& pose, const Twist& twist) const {
  State one = State::Zero();
  one.head<3>() = pose.position;
  one[3] = 1.0;
  one.segment<3>(7) = twist.linear;
  one[12] = twist.yaw_rate;
  return one.replicate(count_, 1);
}

Eigen::VectorXd EulerQuadrotors::input(const Twist&) const {
  return Eigen::VectorXd::Constant(nu(), hover());
}

Eigen::VectorXd EulerQuadrotors::braking_input(const Eigen::Ref<const Eigen::VectorXd>&,
                                               const Eigen::Ref<const Eigen::VectorXd>&,
                                               double) const {
  return input({});
}

double EulerQuadrotors::squared_speed(const Eigen::Ref<const Eigen::VectorXd>& x,
                                      const Eigen::Ref<const Eigen::VectorXd>&,
                                      Eigen::VectorXd* d_x, Eigen::VectorXd* d_u) const {
  if (d_x) {
    d_x->setZero(nx());
    d_x->segment<3>(7) = 2.0 * x.segment<3>(7);
  }
  if (d_u) d_u->setZero(nu());
  return x.segment<3>(7).squaredNorm();
}

double EulerQuadrotors::max_speed() const { return std::numeric_limits<double>::infinity(); }
double EulerQuadrotors::max_yaw_rate() const { return std::numeric_limits<double>::infinity(); }

}  // namespace prospect
