// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/problem/term.h"

namespace prospect::test {

/// A trajectory of random states and inputs (they need not obey the dynamics: a term is a function
/// of both).
inline TrajectoryBatch random_trajectories(const MotionModel& model, int N, double dt, int batch,
                                           double spread, std::mt19937_64& random) {
  TrajectoryBatch t;
  t.horizon = {&model, N, dt};
  t.layout = model.pose_layout();
  t.u_previous = Eigen::VectorXd::Zero(model.nu());
  t.states.resize((N + 1) * model.nx(), batch);
  t.inputs.resize(N * model.nu(), batch);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int b = 0; b < batch; ++b) {
    Eigen::VectorXd at(model.nx());
    for (double& v : at) v = spread * unit(random);
    for (int k = 0; k <= N; ++k) {
      for (int i = 0; i < model.nx(); ++i) {
        at[i] += 0.15 * unit(random);
        t.states(k * model.nx() + i, b) = at[i];
      }
    }
    for (int r = 0; r < t.inputs.rows(); ++r) t.inputs(r, b) = unit(random);
  }
  return t;
}

inline TermOutput outputs(const Term& term, const Horizon& horizon, int batch) {
  TermOutput out;
  out.value.setZero(term.rows(horizon), batch);
  out.state_gradient.setZero((horizon.N + 1) * horizon.nx(), batch);
  out.input_gradient.setZero(horizon.N * horizon.nu(), batch);
  out.jacobian.setZero(std::max(horizon.nx(), horizon.nu()),
                       static_cast<Eigen::Index>(term.jacobian_pattern(horizon).size()));
  return out;
}

inline TermOutput evaluate(const Term& term, const TrajectoryBatch& t, bool gradient) {
  TermOutput out = outputs(term, t.horizon, t.batch());
  const auto scratch = term.make_scratch(t.horizon, t.batch());
  term.evaluate(t, {gradient}, scratch.get(), out);
  return out;
}

/// Dense derivative of all rows with respect to all states and inputs, from what the term wrote.
inline Eigen::MatrixXd written_derivative(const Term& term, const TrajectoryBatch& t) {
  const TermOutput out = evaluate(term, t, true);
  const int nx = t.horizon.nx(), nu = t.horizon.nu();
  const Eigen::Index states = t.states.rows();
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(out.value.rows(), states + t.inputs.rows());
  if (term.traits().kind == TermKind::kCost) {
    D.row(0).head(states) = out.state_gradient.matrix().col(0).transpose();
    D.row(0).tail(t.inputs.rows()) = out.input_gradient.matrix().col(0).transpose();
    return D;
  }
  const auto pattern = term.jacobian_pattern(t.horizon);
  for (std::size_t n = 0; n < pattern.size(); ++n) {
    const JacobianBlock& block = pattern[n];
    const int size = block.input ? nu : nx;
    const Eigen::Index column = block.input ? states + block.stage * nu : block.stage * nx;
    D.row(block.row).segment(column, size) +=
        out.jacobian.col(static_cast<Eigen::Index>(n)).head(size).transpose();
  }
  return D;
}

/// Central differences of every row by every state of stages `first_stage`.. and every input.
inline void expect_derivative_matches_differences(const Term& term, const TrajectoryBatch& t,
                                                  int first_stage, double step, double tolerance) {
  const Eigen::MatrixXd D = written_derivative(term, t);
  const int states = static_cast<int>(t.states.rows());
  for (int c = first_stage * t.horizon.nx(); c < D.cols(); ++c) {
    TrajectoryBatch low = t, high = t;
    double& a = c < states ? low.states(c, 0) : low.inputs(c - states, 0);
    double& b = c < states ? high.states(c, 0) : high.inputs(c - states, 0);
    a -= step;
    b += step;
    const Eigen::VectorXd slope =
        (evaluate(term, high, false).value - evaluate(term, low, false).value).matrix().col(0) /
        (2.0 * step);
    for (int r = 0; r < D.rows(); ++r) {
      ASSERT_NEAR(D(r, c), slope[r], tolerance * std::max(1.0, std::abs(slope[r])))
          << "row " << r << ", column " << c;
    }
  }
}

}  // namespace prospect::test
