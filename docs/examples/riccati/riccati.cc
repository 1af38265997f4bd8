// SPDX-License-Identifier: Apache-2.0
// Solves a problem stage by stage: Gauss-Newton steps by a Riccati recursion over the stages that
// engine/problem/stage_structure.h gives, whose work grows with the horizon and not with its cube.
// Beside it, the same problem by SLSQP.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include "engine/problem/stage_structure.h"
#include "engine/terms/control_effort.h"
#include "engine/terms/input_rate.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Squared distance of every node to a point [m^2], mean over the stages.
class NearPoint final : public prospect::Term {
 public:
  explicit NearPoint(Eigen::Vector2d point) : point_(std::move(point)) {}
  std::string_view name() const override { return "near point"; }
  prospect::TermTraits traits() const override {
    return {prospect::TermKind::kCost, prospect::Smoothness::kSmooth, true, "m^2", "mean"};
  }
  std::optional<prospect::ResidualForm> residual_form(const prospect::Horizon& h,
                                                      int sign) const override {
    if (sign < 0) return std::nullopt;
    prospect::ResidualForm form{0.0, 2 * h.N, {}};
    for (int row = 0; row < form.rows; ++row) form.pattern.push_back({row, row / 2 + 1, false});
    return form;
  }
  void evaluate(const prospect::TrajectoryBatch& t, const prospect::TermRequest& request,
                prospect::TermScratch*, prospect::TermOutput& out) const override {
    const int N = t.horizon.N;
    const double root = std::sqrt(2.0 / N);
    for (int b = 0; b < t.batch(); ++b) {
      double sum = 0.0;
      for (int k = 1; k <= N; ++k) {
        const double dx = t.px(k, b) - point_.x(), dy = t.py(k, b) - point_.y();
        sum += (dx * dx + dy * dy) / N;
        if (request.gradient) out.add_pose_gradient(t, k, b, 2 * dx / N, 2 * dy / N, 0, 0);
        if (request.residuals == 0) continue;
        const int row = 2 * (k - 1);
        out.residuals.segment<2>(row) << root * dx, root * dy;
        out.set_pose_block(t, row, root, 0, 0, 0);
        out.set_pose_block(t, row + 1, 0, root, 0, 0);
      }
      out.value(0, b) = sum;
    }
  }

 private:
  Eigen::Vector2d point_;
};

prospect::Problem make_problem() {
  prospect::ProblemDefinition d;
  d.model = std::make_shared<prospect::Unicycle>(prospect::Unicycle::Parameters{});
  d.x0 = Eigen::Vector3d::Zero();
  d.u_previous = Eigen::Vector2d::Zero();
  d.N = 40;
  d.M = 20;
  const prospect::InputLimits& limits = d.model->limits();
  d.terms.push_back({std::make_shared<NearPoint>(Eigen::Vector2d(1.5, 1.0)), 1.0});
  d.terms.push_back(
      {std::make_shared<prospect::ControlEffort>(Eigen::Vector2d(0.3, 0.0), limits), 0.2});
  d.terms.push_back({std::make_shared<prospect::InputRate>(limits), 0.5});
  return prospect::Problem(std::move(d));
}

/// The Gauss-Newton step of the inputs z, with `damping` added to their curvature.
VectorXd riccati_step(const prospect::Problem& problem, const VectorXd& z,
                      const prospect::StageStructure& chain, double damping) {
  const int N = problem.horizon().N, nu = problem.horizon().nu();
  const Eigen::Index ns = chain.stages.front().gradient_s.size();
  struct Policy {
    MatrixXd K;
    VectorXd k;
  };
  std::vector<Policy> policies(static_cast<std::size_t>(N));
  MatrixXd P = MatrixXd::Zero(ns, ns);  // cost to go: 1/2 s'Ps + p's
  VectorXd p = VectorXd::Zero(ns);
  for (int k = N; k >= 0; --k) {
    const prospect::Stage& s = chain.stages[static_cast<std::size_t>(k)];
    MatrixXd Q = s.residuals_s.transpose() * s.residuals_s;
    VectorXd q = s.residuals_s.transpose() * s.residuals + s.gradient_s;
    if (k == N) {
      P = Q;
      p = q;
      continue;
    }
    const VectorXd next = P * s.gap + p;
    Q += s.A.transpose() * P * s.A;
    q += s.A.transpose() * next;
    if (s.decides) {
      MatrixXd R = s.residuals_v.transpose() * s.residuals_v + s.B.transpose() * P * s.B +
                   damping * MatrixXd::Identity(nu, nu);
      MatrixXd S = s.residuals_v.transpose() * s.residuals_s + s.B.transpose() * P * s.A;
      VectorXd r = s.residuals_v.transpose() * s.residuals + s.gradient_v + s.B.transpose() * next;
      // An input at its bound that the cost pushes outwards stays there.
      for (int j = 0; j < nu; ++j) {
        const int i = problem.knot(k) * nu + j;
        const bool held = (z[i] <= problem.lower()[i] && r[j] > 0.0) ||
                          (z[i] >= problem.upper()[i] && r[j] < 0.0);
        if (!held) continue;
        R.row(j).setZero();
        R.col(j).setZero();
        R(j, j) = 1.0;
        S.row(j).setZero();
        r[j] = 0.0;
      }
      const Eigen::LDLT<MatrixXd> factor(R);
      Policy& policy = policies[static_cast<std::size_t>(k)];
      policy.K = -factor.solve(S);
      policy.k = -factor.solve(r);
      Q += S.transpose() * policy.K;
      q += S.transpose() * policy.k;
    }
    P = 0.5 * (Q + Q.transpose());
    p = q;
  }
  VectorXd step = VectorXd::Zero(problem.num_variables());
  VectorXd state = VectorXd::Zero(ns);
  for (int k = 0; k < N; ++k) {
    const prospect::Stage& s = chain.stages[static_cast<std::size_t>(k)];
    VectorXd moved = s.A * state + s.gap;
    if (s.decides) {
      const Policy& policy = policies[static_cast<std::size_t>(k)];
      const VectorXd v = policy.K * state + policy.k;
      step.segment(problem.knot(k) * nu, nu) = v;
      moved += s.B * v;
    }
    state = moved;
  }
  return step;
}

}  // namespace

int main() {
  const prospect::Problem problem = make_problem();
  VectorXd z = 0.5 * (problem.lower() + problem.upper());
  prospect::StageStructure chain = prospect::stage_structure(problem, z);
  double damping = 1e-3;
  int steps = 0;
  for (int tries = 0; tries < 100 && damping < 1e6; ++tries) {
    const VectorXd to = (z + riccati_step(problem, z, chain, damping))
                            .cwiseMax(problem.lower())
                            .cwiseMin(problem.upper());
    prospect::StageStructure there = prospect::stage_structure(problem, to);
    const double gain = chain.cost - there.cost;
    if (gain <= 0.0) {
      damping *= 10.0;
      continue;
    }
    z = to;
    chain = std::move(there);
    damping = std::max(1e-9, 0.1 * damping);
    ++steps;
    if (gain < 1e-12 * std::max(1.0, chain.cost)) break;
  }
  std::printf("riccati: cost %.8f in %d steps\n", chain.cost, steps);
  const auto solver = prospect::make_solver("nlopt:LD_SLSQP");
  const prospect::Result result = solver->solve(problem, {}, {{"tolerance", 1e-10}}, {});
  std::printf("slsqp:   cost %.8f in %d evaluations\n", result.cost,
              result.counters.cost_evaluations);
  const bool as_good = chain.cost <= result.cost + 1e-6 * std::max(1.0, result.cost);
  std::printf("%s\n", as_good ? "as good as SLSQP" : "worse than SLSQP");
  return as_good ? 0 : 1;
}
