// SPDX-License-Identifier: Apache-2.0
// What every motion model promises, checked over all of them.
#include "models/motion_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "models/make_model.h"
#include "models/numeric_difference.h"

namespace prospect::motion_model_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;

struct Sample {
  VectorXd x, u;
  double dt;
};

class EveryModel : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const MotionModel> model_ = make_model(GetParam());
  std::mt19937_64 rng_{20240117};

  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }

  /// Turn rates from 1e-12 to full scale, either sign, and exactly zero.
  double turn_rate() {
    const double kind = uniform(0.0, 1.0);
    if (kind < 0.1) return 0.0;
    const double sign = uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    if (kind < 0.5) return sign * std::pow(10.0, uniform(-12.0, -3.0));
    return sign * uniform(0.0, 3.0);
  }

  /// Yaws within one turn, next to +-pi, and many turns away.
  double yaw() {
    const double kind = uniform(0.0, 1.0);
    if (kind < 0.4) return uniform(-kPi, kPi);
    if (kind < 0.7)
      return (kind < 0.55 ? kPi : -kPi) + uniform(-1.0, 1.0) * std::pow(10.0, uniform(-12.0, -1.0));
    return uniform(-1000.0, 1000.0);
  }

  Sample sample() {
    const int nx = model_->nx(), nu = model_->nu();
    Sample s{VectorXd(nx), VectorXd(nu),
             uniform(0.0, 1.0) < 0.1 ? uniform(0.5, 2.0) : uniform(0.01, 0.5)};
    for (int i = 0; i < nx; ++i) s.x[i] = uniform(-10.0, 10.0);
    for (int j = 0; j < nu; ++j) s.u[j] = uniform(0.0, 1.0) < 0.1 ? 0.0 : uniform(-2.0, 2.0);
    s.x[model_->pose_layout().yaw] = yaw();
    const std::string name(model_->name());
    if (name == "unicycle_accel") {
      s.x[3] = uniform(-1.0, 1.0);
      s.x[4] = turn_rate();
      if (uniform(0.0, 1.0) < 0.5) s.u[1] = turn_rate();
    } else {
      s.u[nu - 1] = turn_rate();
    }
    return s;
  }

  VectorXd step(const VectorXd& x, const VectorXd& u, double dt) const {
    VectorXd next = VectorXd::Constant(model_->nx(), std::numeric_limits<double>::quiet_NaN());
    model_->step(x, u, dt, next);
    return next;
  }

  VectorXd within_bounds() {
    const InputLimits& limits = model_->limits();
    VectorXd u(model_->nu());
    for (int j = 0; j < u.size(); ++j) u[j] = uniform(limits.lower[j], limits.upper[j]);
    return u;
  }
};

TEST_P(EveryModel, JacobiansAgreeWithTheirFiniteDifferenceTwin) {
  const NumericDifference twin(model_);
  const int nx = model_->nx(), nu = model_->nu();
  for (int n = 0; n < 3000; ++n) {
    const Sample s = sample();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    MatrixXd A = MatrixXd::Constant(nx, nx, nan), B = MatrixXd::Constant(nx, nu, nan);
    MatrixXd A_twin(nx, nx), B_twin(nx, nu);
    model_->jacobians(s.x, s.u, s.dt, A, B);
    twin.jacobians(s.x, s.u, s.dt, A_twin, B_twin);
    ASSERT_TRUE(A.allFinite() && B.allFinite());
    // Rounding of the twin: 1.5 eps |f|/h with |f| up to 1000 rad; truncation below 1e-12.
    const double tolerance = 1e-11 + 4e-13 * step(s.x, s.u, s.dt).cwiseAbs().maxCoeff();
    ASSERT_LE((A - A_twin).cwiseAbs().maxCoeff(), tolerance)
        << "x " << s.x.transpose() << "  u " << s.u.transpose() << "  dt " << s.dt << "\n"
        << A << "\n\n"
        << A_twin;
    ASSERT_LE((B - B_twin).cwiseAbs().maxCoeff(), tolerance)
        << "x " << s.x.transpose() << "  u " << s.u.transpose() << "  dt " << s.dt << "\n"
        << B << "\n\n"
        << B_twin;
  }
}

TEST_P(EveryModel, NothingJumpsWhenTheTurnRatePassesZero) {
  // Along a line of turn rates through zero, value and Jacobians change by no more than the change
  // of the turn rate times a modest constant.
  const int nx = model_->nx(), nu = model_->nu();
  const bool in_state = model_->name() == "unicycle_accel";
  const auto at = [&](double omega, VectorXd& next, MatrixXd& A, MatrixXd& B) {
    VectorXd x = VectorXd::LinSpaced(nx, 0.3, 0.9), u = VectorXd::LinSpaced(nu, 0.4, 0.6);
    if (in_state) u[1] = 0.0;
    (in_state ? x[4] : u[nu - 1]) = omega;
    model_->step(x, u, 0.3, next);
    model_->jacobians(x, u, 0.3, A, B);
  };
  VectorXd f0(nx), f(nx);
  MatrixXd A0(nx, nx), B0(nx, nu), A(nx, nx), B(nx, nu);
  at(0.0, f0, A0, B0);
  for (double exponent = -18.0; exponent <= -1.0; exponent += 0.01) {
    for (double sign : {-1.0, 1.0}) {
      const double omega = sign * std::pow(10.0, exponent);
      at(omega, f, A, B);
      const double bound = std::abs(omega) + 1e-15;
      ASSERT_LE((f - f0).cwiseAbs().maxCoeff(), bound) << omega;
      ASSERT_LE((A - A0).cwiseAbs().maxCoeff(), bound) << omega;
      ASSERT_LE((B - B0).cwiseAbs().maxCoeff(), bound) << omega;
    }
  }
}

TEST_P(EveryModel, TwoHalfStepsAreOneStep) {
  const bool exact = model_->name() != "unicycle_accel";
  for (int n = 0; n < 2000; ++n) {
    Sample s = sample();
    if (!exact) {
      // Within the documented limits; the bound is the documented error of a position.
      s.x[3] = uniform(0.0, 0.6);
      s.x[4] = uniform(-1.0, 1.0);
      s.u = within_bounds();
      s.dt = uniform(0.01, 0.25);
    }
    const VectorXd once = step(s.x, s.u, s.dt);
    const VectorXd twice = step(step(s.x, s.u, 0.5 * s.dt), s.u, 0.5 * s.dt);
    const double rounding = 4e-15 * (10.0 + s.x.cwiseAbs().maxCoeff());
    const double tolerance = exact ? rounding : 5e-5;
    ASSERT_LE((once - twice).cwiseAbs().maxCoeff(), tolerance)
        << "x " << s.x.transpose() << "  u " << s.u.transpose() << "  dt " << s.dt;
  }
}

TEST_P(EveryModel, StepForgetsWhereItStartsAndWhichTurnItIsIn) {
  // Moving and turning the start by a planar motion moves and turns the result (B-frame inputs),
  // and full turns of the yaw change nothing but the yaw.
  for (int n = 0; n < 500; ++n) {
    Sample s = sample();
    const PoseLayout layout = model_->pose_layout();
    s.x[layout.yaw] = uniform(-kPi, kPi);
    VectorXd turned = s.x;
    turned[layout.yaw] += 2.0 * kPi;
    turned[layout.px] += 5.0;
    turned[layout.py] -= 3.0;
    VectorXd expected = step(s.x, s.u, s.dt);
    expected[layout.yaw] += 2.0 * kPi;
    expected[layout.px] += 5.0;
    expected[layout.py] -= 3.0;
    ASSERT_LE((step(turned, s.u, s.dt) - expected).cwiseAbs().maxCoeff(), 2e-14);
  }
}

TEST_P(EveryModel, BatchEqualsSingleStepsToTheBit) {
  const int nx = model_->nx(), nu = model_->nu();
  for (int batch : {0, 1, 2, 3, 7, 64, 1001}) {
    BatchArray x(nx, batch), u(nu, batch);
    for (int b = 0; b < batch; ++b) {
      const Sample s = sample();
      x.col(b) = s.x.array();
      u.col(b) = s.u.array();
    }
    for (double dt : {0.1, 0.25, 1.0}) {
      // As rolled out in a horizon: rows of one array, the next state right below the present one.
      BatchArray states = BatchArray::Zero(2 * nx, batch);
      states.topRows(nx) = x;
      model_->step_batch(states.topRows(nx), u, dt, states.bottomRows(nx));
      for (int b = 0; b < batch; ++b) {
        const VectorXd next = step(x.col(b).matrix(), u.col(b).matrix(), dt);
        for (int i = 0; i < nx; ++i) ASSERT_EQ(states(nx + i, b), next[i]) << b << ' ' << i;
      }
    }
  }
}

TEST_P(EveryModel, LimitsAreConsistent) {
  const InputLimits& limits = model_->limits();
  ASSERT_EQ(limits.lower.size(), model_->nu());
  ASSERT_EQ(limits.upper.size(), model_->nu());
  ASSERT_EQ(limits.rate.size(), model_->nu());
  EXPECT_TRUE((limits.lower.array() <= 0.0).all());
  EXPECT_TRUE((limits.upper.array() > 0.0).all());
  EXPECT_TRUE((limits.rate.array() > 0.0).all());
  EXPECT_TRUE(limits.lower.allFinite() && limits.upper.allFinite());
  EXPECT_GT(model_->max_speed(), 0.0);
  EXPECT_GT(model_->max_yaw_rate(), 0.0);
  EXPECT_GT(model_->max_deceleration(), 0.0);
}

TEST_P(EveryModel, NoAdmissibleInputAndStateIsFasterThanMaxSpeed) {
  double fastest = 0.0;
  for (int n = 0; n < 20000; ++n) {
    VectorXd x = sample().x;
    VectorXd u = within_bounds();
    if (n % 2 == 0) {
      for (int j = 0; j < u.size(); ++j) {
        u[j] = u[j] > 0.0 ? model_->limits().upper[j] : model_->limits().lower[j];
      }
    }
    if (model_->num_state_constraints() > 0) {
      for (int i = 3; i < 6 && i < x.size(); ++i) x[i] = uniform(-2.0, 2.0);
      VectorXd margins(model_->num_state_constraints());
      model_->state_constraints(x, margins, nullptr);
      if (margins.minCoeff() < 0.0) continue;
    }
    const double speed = std::sqrt(model_->squared_speed(x, u, nullptr, nullptr));
    ASSERT_LE(speed, model_->max_speed() * (1.0 + 1e-12));
    ASSERT_LE(std::abs(model_->twist(x, u).yaw_rate), model_->max_yaw_rate());
    fastest = std::max(fastest, speed);
  }
  EXPECT_GT(fastest, 0.9 * model_->max_speed()) << "max_speed is far from what can be reached";
}

TEST_P(EveryModel, SquaredSpeedIsThatOfTheTwistAndOfTheMotion) {
  for (int n = 0; n < 500; ++n) {
    const Sample s = sample();
    const double squared = model_->squared_speed(s.x, s.u, nullptr, nullptr);
    EXPECT_NEAR(squared, model_->twist(s.x, s.u).linear.squaredNorm(), 1e-12 * (1.0 + squared));
    // The displacement of a tiny step has that speed, and its yaw turns at the twist's rate.
    const double dt = 1e-6;
    const VectorXd next = step(s.x, s.u, dt);
    const Eigen::Vector3d velocity =
        (model_->pose(next).position - model_->pose(s.x).position) / dt;
    EXPECT_NEAR(velocity.norm(), std::sqrt(squared), 1e-5);
    EXPECT_NEAR((model_->pose(next).yaw - model_->pose(s.x).yaw) / dt,
                model_->twist(s.x, s.u).yaw_rate, 1e-5);
    // And in the direction of the twist, seen from B.
    const double c = std::cos(model_->pose(s.x).yaw), r = std::sin(model_->pose(s.x).yaw);
    const Eigen::Vector3d in_body(c * velocity.x() + r * velocity.y(),
                                  -r * velocity.x() + c * velocity.y(), velocity.z());
    EXPECT_LE((in_body - model_->twist(s.x, s.u).linear).norm(), 2e-5);
  }
}

TEST_P(EveryModel, GradientOfSquaredSpeedAgreesWithDifferences) {
  const double h = 1e-3;  // central differences are exact for quadratics
  for (int n = 0; n < 1000; ++n) {
    const Sample s = sample();
    VectorXd d_x, d_u;
    model_->squared_speed(s.x, s.u, &d_x, &d_u);
    ASSERT_EQ(d_x.size(), model_->nx());
    ASSERT_EQ(d_u.size(), model_->nu());
    for (int i = 0; i < model_->nx() + model_->nu(); ++i) {
      VectorXd xp = s.x, xm = s.x, up = s.u, um = s.u;
      const bool in_x = i < model_->nx();
      const int j = in_x ? i : i - model_->nx();
      (in_x ? xp : up)[j] += h;
      (in_x ? xm : um)[j] -= h;
      const double difference = (model_->squared_speed(xp, up, nullptr, nullptr) -
                                 model_->squared_speed(xm, um, nullptr, nullptr)) /
                                (2.0 * h);
      ASSERT_NEAR((in_x ? d_x : d_u)[j], difference, 1e-9) << i;
    }
  }
}

TEST_P(EveryModel, StateConstraintsHaveTheGradientTheyClaim) {
  const int rows = model_->num_state_constraints();
  const double h = 1e-3;  // rows are at most quadratic
  for (int n = 0; n < 1000; ++n) {
    const Sample s = sample();
    VectorXd values(rows), plus(rows), minus(rows);
    MatrixXd d_x;
    model_->state_constraints(s.x, values, &d_x);
    ASSERT_EQ(d_x.rows(), rows);
    ASSERT_EQ(d_x.cols(), model_->nx());
    for (int i = 0; i < model_->nx(); ++i) {
      VectorXd xp = s.x, xm = s.x;
      xp[i] += h;
      xm[i] -= h;
      model_->state_constraints(xp, plus, nullptr);
      model_->state_constraints(xm, minus, nullptr);
      for (int r = 0; r < rows; ++r) ASSERT_NEAR(d_x(r, i), (plus[r] - minus[r]) / (2.0 * h), 1e-9);
    }
  }
}

TEST_P(EveryModel, StateAndInputInvertPoseAndTwist) {
  for (int n = 0; n < 500; ++n) {
    const Sample s = sample();
    const Pose pose = model_->pose(s.x);
    const Twist twist = model_->twist(s.x, s.u);
    const VectorXd x = model_->state(pose, twist);
    const VectorXd u = model_->input(twist);
    ASSERT_EQ(x.size(), model_->nx());
    ASSERT_EQ(u.size(), model_->nu());
    EXPECT_EQ(model_->pose(x).position, pose.position);
    EXPECT_EQ(model_->pose(x).yaw, pose.yaw);
    EXPECT_LE((model_->twist(x, u).linear - twist.linear).norm(), 1e-13);
    EXPECT_EQ(model_->twist(x, u).yaw_rate, twist.yaw_rate);
  }
}

TEST_P(EveryModel, BrakingReachesRestWithinBoundsAndRates) {
  const InputLimits& limits = model_->limits();
  for (int n = 0; n < 500; ++n) {
    const double dt = uniform(0.02, 0.4);
    // An admissible motion: any input in bounds, and a velocity in the state from the same twist.
    VectorXd x = sample().x;
    for (int i = 3; i < std::min(6, model_->nx()); ++i) x[i] = uniform(-0.5, 0.5);
    VectorXd u = within_bounds();
    const double speed = std::sqrt(model_->squared_speed(x, u, nullptr, nullptr));
    const double a = model_->max_deceleration();
    double last = speed, way = 0.0;
    const int steps = static_cast<int>(std::ceil(4.0 / dt)) + 2;  // every default stops within 4 s
    for (int k = 0; k < steps; ++k) {
      const VectorXd braking = model_->braking_input(x, u, dt);
      ASSERT_EQ(braking.size(), model_->nu());
      for (int j = 0; j < braking.size(); ++j) {
        ASSERT_GE(braking[j], limits.lower[j]);
        ASSERT_LE(braking[j], limits.upper[j]);
        ASSERT_LE(std::abs(braking[j] - u[j]), limits.rate[j] * dt * (1.0 + 1e-12));
      }
      const VectorXd next = step(x, braking, dt);
      way += (model_->pose(next).position - model_->pose(x).position).norm();
      const double now = std::sqrt(model_->squared_speed(next, braking, nullptr, nullptr));
      ASSERT_LE(now, last * (1.0 + 1e-12) + 1e-15) << "braking must not speed up";
      x = next;
      u = braking;
      last = now;
    }
    EXPECT_LE(last, 1e-12);
    EXPECT_LE(std::abs(model_->twist(x, u).yaw_rate), 1e-12);
    // Each of up to three axes stops within v_i^2/(2a) + a dt^2/8.
    EXPECT_LE(way, speed * speed / (2.0 * a) + 3.0 * a * dt * dt / 8.0 + 1e-9);
  }
}

TEST_P(EveryModel, BrakingFromOutsideTheBoundsComesBackInside) {
  const InputLimits& limits = model_->limits();
  const VectorXd x = VectorXd::Constant(model_->nx(), 5.0);
  for (double sign : {-1.0, 1.0}) {
    const VectorXd u = model_->braking_input(x, VectorXd::Constant(model_->nu(), sign * 50.0), 0.1);
    EXPECT_TRUE((u.array() >= limits.lower.array()).all());
    EXPECT_TRUE((u.array() <= limits.upper.array()).all());
  }
}

TEST_P(EveryModel, ExtremeButFiniteInputGivesFiniteResults) {
  const int nx = model_->nx(), nu = model_->nu();
  const std::vector<double> magnitudes = {0.0, 5e-324, 1e-300, 1e-12, 1.0, 1e6, 1e9};
  for (double mx : magnitudes) {
    for (double mu : magnitudes) {
      for (double dt : {1e-9, 0.2, 10.0}) {
        const VectorXd x = VectorXd::Constant(nx, -mx), u = VectorXd::Constant(nu, mu);
        MatrixXd A(nx, nx), B(nx, nu);
        model_->jacobians(x, u, dt, A, B);
        EXPECT_TRUE(A.allFinite() && B.allFinite()) << mx << ' ' << mu << ' ' << dt;
        EXPECT_TRUE(step(x, u, dt).allFinite()) << mx << ' ' << mu << ' ' << dt;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, EveryModel, testing::ValuesIn(model_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace prospect::motion_model_test
