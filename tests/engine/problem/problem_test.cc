// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>

namespace prospect::problem_test {
namespace {

/// A deliberately nonlinear model whose state mixes everything, to exercise the adjoint sweep.
class MixingModel : public MotionModel {
 public:
  MixingModel() {
    limits_.lower = Eigen::Vector2d(-1.0, -2.0);
    limits_.upper = Eigen::Vector2d(1.5, 2.0);
    limits_.rate = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  }
  std::string_view name() const override { return "mixing"; }
  int nx() const override { return 3; }
  int nu() const override { return 2; }
  void step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& u,
            double dt, Eigen::Ref<Eigen::VectorXd> next) const override {
    next[0] = x[0] + dt * u[0] * std::cos(x[2]) + 0.1 * dt * x[1] * x[1];
    next[1] = x[1] + dt * u[0] * std::sin(x[2]) + dt * u[1] * u[0];
    next[2] = x[2] + dt * u[1] + 0.2 * dt * std::sin(x[0]);
  }
  void jacobians(const Eigen::Ref<const Eigen::VectorXd>& x,
                 const Eigen::Ref<const Eigen::VectorXd>& u, double dt,
                 Eigen::Ref<Eigen::MatrixXd> A, Eigen::Ref<Eigen::MatrixXd> B) const override {
    A << 1.0, 0.2 * dt * x[1], -dt * u[0] * std::sin(x[2]),  //
        0.0, 1.0, dt * u[0] * std::cos(x[2]),                //
        0.2 * dt * std::cos(x[0]), 0.0, 1.0;
    B << dt * std::cos(x[2]), 0.0,                   //
        dt * std::sin(x[2]) + dt * u[1], dt * u[0],  //
        0.0, dt;
  }
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>& u,
                  double dt, Eigen::Ref<BatchArray> next) const override {
    Eigen::VectorXd out(3);
    for (Eigen::Index b = 0; b < x.cols(); ++b) {
      step(x.col(b).matrix(), u.col(b).matrix(), dt, out);
      next.col(b) = out.array();
    }
  }
  const InputLimits& limits() const override { return limits_; }
  PoseLayout pose_layout() const override { return {}; }
  Twist twist(const Eigen::Ref<const Eigen::VectorXd>&,
              const Eigen::Ref<const Eigen::VectorXd>&) const override {
    return {};
  }
  Eigen::VectorXd state(const Pose& p, const Twist&) const override {
    return Eigen::Vector3d(p.position.x(), p.position.y(), p.yaw);
  }
  Eigen::VectorXd input(const Twist&) const override { return Eigen::Vector2d::Zero(); }
  Eigen::VectorXd braking_input(const Eigen::Ref<const Eigen::VectorXd>&,
                                const Eigen::Ref<const Eigen::VectorXd>&, double) const override {
    return Eigen::Vector2d::Zero();
  }
  double squared_speed(const Eigen::Ref<const Eigen::VectorXd>&,
                       const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd*,
                       Eigen::VectorXd*) const override {
    return u[0] * u[0];
  }
  double max_speed() const override { return 1.5; }
  double max_yaw_rate() const override { return 2.0; }
  double max_deceleration() const override { return 1.0; }

 private:
  InputLimits limits_;
};

/// sum_k k x_k[0]^2 sin(x_k[1]) + x_k[2] u_k[1]^3: depends on every state and input.
class MixedCost : public Term {
 public:
  std::string_view name() const override { return "mixed"; }
  TermTraits traits() const override {
    return {TermKind::kCost, Smoothness::kSmooth, true, "-", ""};
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    out.value.setZero();
    for (int b = 0; b < t.batch(); ++b) {
      for (int k = 0; k <= t.horizon.N; ++k) {
        const double x = t.x(k, 0, b), y = t.x(k, 1, b), th = t.x(k, 2, b);
        out.value(0, b) += k * x * x * std::sin(y);
        if (request.gradient) {
          out.state_gradient(3 * k, b) += 2.0 * k * x * std::sin(y);
          out.state_gradient(3 * k + 1, b) += k * x * x * std::cos(y);
        }
        if (k == t.horizon.N) continue;
        const double u = t.u(k, 1, b);
        out.value(0, b) += th * u * u * u;
        if (request.gradient) {
          out.state_gradient(3 * k + 2, b) += u * u * u;
          out.input_gradient(2 * k + 1, b) += 3.0 * th * u * u;
        }
      }
    }
  }
};

/// Row k: x_{k+1}[0] x_{k+1}[2] + u_k[0]^2 - 1, one row a stage, from a state and an input block.
class MixedConstraint : public Term {
 public:
  std::string_view name() const override { return "mixed constraint"; }
  TermTraits traits() const override {
    return {TermKind::kConstraint, Smoothness::kSmooth, true, "-", ""};
  }
  int rows(const Horizon& h) const override { return h.N; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& h) const override {
    std::vector<JacobianBlock> blocks;
    for (int k = 0; k < h.N; ++k) {
      blocks.push_back({k, k + 1, false});
      blocks.push_back({k, k, true});
    }
    return blocks;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      for (int k = 0; k < t.horizon.N; ++k) {
        out.value(k, b) = t.x(k + 1, 0, b) * t.x(k + 1, 2, b) + t.u(k, 0, b) * t.u(k, 0, b) - 1.0;
        if (!request.gradient) continue;
        out.jacobian.col(2 * k) << t.x(k + 1, 2, b), 0.0, t.x(k + 1, 0, b);
        out.jacobian.col(2 * k + 1) << 2.0 * t.u(k, 0, b), 0.0, 0.0;
      }
    }
  }
};

/// NaN wherever the first input of the candidate is above a threshold.
class Brittle : public Term {
 public:
  std::string_view name() const override { return "brittle"; }
  TermTraits traits() const override { return {}; }
  void evaluate(const TrajectoryBatch& t, const TermRequest&, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      out.value(0, b) = t.u(0, 0, b) > 0.5 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
    }
  }
};

ProblemDefinition definition(int N, int M) {
  ProblemDefinition d;
  d.model = std::make_shared<MixingModel>();
  d.x0 = Eigen::Vector3d(0.3, -0.2, 0.5);
  d.u_previous = Eigen::Vector2d::Zero();
  d.N = N;
  d.dt = 0.2;
  d.M = M;
  d.terms = {{std::make_shared<MixedCost>(), 0.7},
             {std::make_shared<MixedConstraint>(), 1.0},
             {std::make_shared<MixedCost>(), -0.2}};
  return d;
}

Eigen::MatrixXd random_points(const Problem& p, int count, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Eigen::MatrixXd X(p.num_variables(), count);
  for (int b = 0; b < count; ++b) {
    for (int i = 0; i < p.num_variables(); ++i) {
      X(i, b) = p.lower()[i] + unit(generator) * (p.upper()[i] - p.lower()[i]);
    }
  }
  return X;
}

TEST(Problem, GradientAndJacobianMatchFiniteDifferences) {
  for (const auto& [N, M] : {std::pair{1, 1}, {7, 7}, {12, 5}, {9, 2}, {20, 1}}) {
    const Problem problem(definition(N, M));
    Workspace workspace = problem.make_workspace();
    const Eigen::MatrixXd X = random_points(problem, 20, 3);
    Evaluation at, plus, minus;
    for (int b = 0; b < X.cols(); ++b) {
      ASSERT_TRUE(problem.evaluate(X.col(b), Evaluate::kGradient, workspace, at));
      const double scale = 1.0 + at.gradient.cwiseAbs().maxCoeff();
      for (int i = 0; i < problem.num_variables(); ++i) {
        const double h = 1e-6;
        Eigen::VectorXd z = X.col(b);
        z[i] += h;
        problem.evaluate(z, Evaluate::kValue, workspace, plus);
        z[i] -= 2.0 * h;
        problem.evaluate(z, Evaluate::kValue, workspace, minus);
        EXPECT_NEAR(at.gradient[i], (plus.cost[0] - minus.cost[0]) / (2.0 * h), 1e-6 * scale);
        const Eigen::VectorXd column = (plus.constraints - minus.constraints).col(0) / (2.0 * h);
        EXPECT_LT((at.jacobian.col(i) - column).cwiseAbs().maxCoeff(), 1e-6);
        for (int r = 0; r < problem.num_constraints(); ++r) {
          if (!problem.jacobian_pattern()(r, i)) {
            EXPECT_EQ(at.jacobian(r, i), 0.0);
            EXPECT_EQ(column[r], 0.0) << "the pattern misses row " << r << ", variable " << i;
          }
        }
      }
    }
  }
}

/// A cost of inputs alone with linear residuals that couple neighbours:
/// 1/2 sum_k (u_k[0] - 2 u_{k-1}[1])^2 + 1/2 u_0[0]^2.
class Neighbours : public Term {
 public:
  std::string_view name() const override { return "neighbours"; }
  TermTraits traits() const override { return {}; }
  std::optional<ResidualForm> residual_form(const Horizon& h, int sign) const override {
    if (sign < 0) return std::nullopt;
    ResidualForm form{0.0, h.N, {{0, 0, true}}};
    for (int k = 1; k < h.N; ++k) {
      form.pattern.push_back({k, k, true});
      form.pattern.push_back({k, k - 1, true});
    }
    return form;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    out.value.setZero();
    for (int b = 0; b < t.batch(); ++b) {
      for (int k = 0; k < t.horizon.N; ++k) {
        const double r = t.u(k, 0, b) - (k > 0 ? 2.0 * t.u(k - 1, 1, b) : 0.0);
        out.value(0, b) += 0.5 * r * r;
        if (request.gradient) {
          out.input_gradient(2 * k, b) += r;
          if (k > 0) out.input_gradient(2 * k - 1, b) -= 2.0 * r;
        }
        if (request.residuals == 0) continue;
        out.residuals[k] = r;
        const int first = k == 0 ? 0 : 2 * k - 1;
        out.jacobian.col(first) << 1.0, 0.0, 0.0;
        if (k > 0) out.jacobian.col(first + 1) << 0.0, -2.0, 0.0;
      }
    }
  }
};

TEST(Problem, StagesOfARolloutAreThoseOfItsGradient) {
  for (const auto& [N, M] : {std::pair{1, 1}, {12, 5}, {20, 20}}) {
    ProblemDefinition d = definition(N, M);
    d.terms.push_back({std::make_shared<Neighbours>(), 3.0});
    const Problem problem(d);
    Workspace workspace = problem.make_workspace();
    const Eigen::VectorXd z = random_points(problem, 1, 5);
    Evaluation gradient, out, own;
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kGradient, workspace, gradient));
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kStages, workspace, out));
    EXPECT_EQ(out.cost[0], gradient.cost[0]);
    // Neighbours gives its gradient by its residuals: to rounding.
    EXPECT_LT((out.gradient - gradient.gradient).norm(), 1e-12 * (1.0 + gradient.gradient.norm()));
    EXPECT_EQ(out.jacobian, gradient.jacobian);
    EXPECT_EQ(out.stages.gap, 0.0);
    EXPECT_TRUE(out.stages.drift.isZero(0.0));
    EXPECT_TRUE(out.stages.constraint_drift.isZero(0.0));
    ASSERT_TRUE(problem.evaluate_states(z, out.stages.states, workspace, own));
    EXPECT_EQ(own.cost[0], out.cost[0]);
    EXPECT_EQ(own.gradient, out.gradient);
  }
}

TEST(Problem, StagesAtStatesOfOnesOwnMatchFiniteDifferences) {
  const double h = 1e-6;
  for (const auto& [N, M] : {std::pair{1, 1}, {12, 5}, {9, 9}}) {
    ProblemDefinition d = definition(N, M);
    d.terms.push_back({std::make_shared<Neighbours>(), 3.0});
    const Problem problem(d);
    Workspace workspace = problem.make_workspace();
    std::mt19937_64 generator(7);
    std::normal_distribution<double> normal(0.0, 0.3);
    for (int b = 0; b < 5; ++b) {
      const Eigen::VectorXd z = random_points(problem, 1, 6 + static_cast<unsigned>(b));
      Eigen::MatrixXd X = d.x0.replicate(1, N + 1);
      for (double& x : X.rightCols(N).reshaped()) x += normal(generator);
      Evaluation at, moved;
      ASSERT_TRUE(problem.evaluate_states(z, X, workspace, at));
      const StageDerivatives& stages = at.stages;
      EXPECT_EQ(stages.states, X);
      EXPECT_GT(stages.gap, 0.01);
      const auto value = [&](const Eigen::VectorXd& dz, const Eigen::MatrixXd& dX) {
        EXPECT_TRUE(problem.evaluate_states(z + dz, X + dX, workspace, moved));
        return moved.cost[0];
      };
      const Eigen::VectorXd still = Eigen::VectorXd::Zero(z.size());
      // The states move with the variables as S_k says.
      for (Eigen::Index i = 0; i < z.size(); ++i) {
        Eigen::MatrixXd dX(3, N + 1);
        for (int k = 0; k <= N; ++k)
          dX.col(k) = h * stages.sensitivity[static_cast<std::size_t>(k)].col(i);
        const Eigen::VectorXd dz = h * Eigen::VectorXd::Unit(z.size(), i);
        const double plus = value(dz, dX);
        const Eigen::VectorXd c_plus = moved.constraints;
        const double minus = value(-dz, -dX);
        const Eigen::VectorXd c_minus = moved.constraints;
        EXPECT_NEAR(at.gradient[i], (plus - minus) / (2.0 * h), 1e-5 * (1.0 + at.gradient.norm()));
        EXPECT_LT((at.jacobian.col(i) - (c_plus - c_minus) / (2.0 * h)).cwiseAbs().maxCoeff(),
                  1e-6);
      }
      // A state moves by itself. Neighbours does not know.
      for (Eigen::Index i = 0; i < X.size(); ++i) {
        Eigen::MatrixXd dX = Eigen::MatrixXd::Zero(3, N + 1);
        dX.reshaped()[i] = h;
        const double difference = value(still, dX) - value(still, -dX);
        EXPECT_NEAR(stages.state_gradient.reshaped()[i], difference / (2.0 * h), 1e-5);
      }
      // The drift closes the gaps to first order.
      const auto gap = [&](double share) {
        value(still, share * stages.drift);
        return moved.stages.gap;
      };
      EXPECT_NEAR((gap(h) - gap(-h)) / (2.0 * h), -stages.gap, 1e-5 * (1.0 + stages.gap));
      value(still, h * stages.drift);
      const Eigen::VectorXd c_plus = moved.constraints;
      value(still, -h * stages.drift);
      const Eigen::VectorXd slope = (c_plus - moved.constraints.col(0)) / (2.0 * h);
      EXPECT_LT((slope - stages.constraint_drift).cwiseAbs().maxCoeff(), 1e-5);
    }
  }
}

TEST(Problem, InputHessianIsThatOfCostsOfInputsAlone) {
  ProblemDefinition d = definition(12, 5);
  d.terms = {{std::make_shared<Neighbours>(), 3.0}};
  const Problem problem(d);
  Workspace workspace = problem.make_workspace();
  const Eigen::VectorXd z = random_points(problem, 1, 8);
  Evaluation at, moved;
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kStages, workspace, at));
  EXPECT_TRUE(at.stages.state_gradient.isZero(0.0));
  // The cost is quadratic: differences of the gradient are exact.
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    problem.evaluate(z + Eigen::VectorXd::Unit(z.size(), i), Evaluate::kGradient, workspace, moved);
    EXPECT_LT((moved.gradient - at.gradient - at.stages.input_hessian.col(i)).norm(), 1e-9);
  }
  EXPECT_GT(at.stages.input_hessian.norm(), 1.0);
}

TEST(Problem, ABatchEqualsItsColumnsBitForBit) {
  const Problem problem(definition(12, 5));
  Workspace batch_workspace = problem.make_workspace();
  Workspace single_workspace = problem.make_workspace();
  const Eigen::MatrixXd X = random_points(problem, 33, 4);
  Evaluation batch, single;
  ASSERT_TRUE(problem.evaluate(X, Evaluate::kValue, batch_workspace, batch));
  for (int b = 0; b < X.cols(); ++b) {
    problem.evaluate(X.col(b), Evaluate::kGradient, single_workspace, single);
    EXPECT_EQ(single.cost[0], batch.cost[b]);
    EXPECT_EQ(single.constraints.col(0), batch.constraints.col(b));
  }
}

TEST(Problem, RejectsOnlyTheCandidatesThatCannotBeEvaluated) {
  ProblemDefinition d = definition(4, 2);
  d.terms.push_back({std::make_shared<Brittle>(), 1.0});
  const Problem problem(d);
  Workspace workspace = problem.make_workspace();
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(problem.num_variables(), 3);
  X(0, 1) = 1.0;
  Evaluation out;
  EXPECT_FALSE(problem.evaluate(X, Evaluate::kValue, workspace, out));
  EXPECT_TRUE(out.valid[0]);
  EXPECT_FALSE(out.valid[1]);
  EXPECT_TRUE(out.valid[2]);
  EXPECT_EQ(out.cost[1], Problem::kRejectedCost);
  EXPECT_TRUE(out.cost.allFinite());
  EXPECT_EQ(out.cost[0], out.cost[2]);
}

TEST(Problem, ExplainsEveryTermRawAndWeighted) {
  const Problem problem(definition(6, 3));
  const Eigen::VectorXd z = random_points(problem, 1, 9);
  const Explanation e = problem.explain(z);
  ASSERT_EQ(e.terms.size(), 3u);
  EXPECT_NEAR(e.terms[0].weighted + e.terms[2].weighted, e.cost, 1e-12);
  EXPECT_NEAR(e.terms[0].weighted, 0.7 * e.terms[0].raw, 1e-15);
  EXPECT_TRUE(e.terms[1].constraint);
  EXPECT_NEAR(e.violation, std::max(0.0, -e.terms[1].raw), 1e-15);
}

TEST(Problem, MoveBlockingHoldsInputsAndRoundTrips) {
  const Problem problem(definition(10, 4));
  const Eigen::VectorXd z = random_points(problem, 1, 12);
  const TrajectoryBatch t = problem.rollout(z);
  Eigen::MatrixXd inputs(10, 2);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(t.u(k, 0, 0), z[2 * problem.knot(k)]);
    inputs.row(k) << t.u(k, 0, 0), t.u(k, 1, 0);
  }
  EXPECT_LT((problem.knots_from_inputs(inputs) - z).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Problem, SaysWhatIsWrongWithADefinition) {
  const auto message = [](auto&& change) {
    ProblemDefinition d = definition(6, 3);
    change(d);
    try {
      Problem problem(d);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(message([](auto& d) { d.N = 0; }).find("N = 0"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.M = 7; }).find("M = 7"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.dt = -1.0; }).find("dt"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.x0[1] = std::nan(""); }).find("x0"), std::string::npos);
  EXPECT_NE(message([](auto& d) { d.terms[0].weight = std::nan(""); }).find("mixed"),
            std::string::npos);
  EXPECT_NE(message([](auto& d) { d.terms[0].term = nullptr; }).find("null"), std::string::npos);
  EXPECT_EQ(message([](auto&) {}), "");
}

}  // namespace
}  // namespace prospect::problem_test
