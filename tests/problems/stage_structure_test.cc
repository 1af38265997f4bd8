// SPDX-License-Identifier: Apache-2.0
#include "engine/problem/stage_structure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "engine/terms/control_effort.h"
#include "engine/terms/input_rate.h"
#include "problems/path_problem.h"
#include "problems/r1.h"

namespace prospect::stage_structure_test {
namespace {

/// What the stages say of the whole problem: gradient, Gauss-Newton matrix and Jacobian by z, by
/// the chain of the linearised stages.
struct Whole {
  Eigen::VectorXd gradient, residuals, constraints;
  Eigen::MatrixXd residual_jacobian, constraint_jacobian;
};

Whole chained(const Problem& problem, const StageStructure& stages) {
  const int n = problem.num_variables(), nu = problem.horizon().nu();
  Whole whole;
  whole.gradient.setZero(n);
  Eigen::Index residuals = 0, constraints = 0;
  for (const Stage& stage : stages.stages) {
    residuals += stage.residuals.size();
    constraints += stage.constraints.size();
  }
  whole.residuals.resize(residuals);
  whole.residual_jacobian.resize(residuals, n);
  whole.constraints.resize(constraints);
  whole.constraint_jacobian.resize(constraints, n);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(stages.stages[0].gradient_s.size(), n);  // ds/dz
  Eigen::Index r = 0, c = 0;
  for (std::size_t k = 0; k < stages.stages.size(); ++k) {
    const Stage& s = stages.stages[k];
    Eigen::MatrixXd V = Eigen::MatrixXd::Zero(nu, n);  // dv/dz
    if (s.decides) {
      V.middleCols(problem.knot(static_cast<int>(k)) * nu, nu).setIdentity();
    }
    whole.gradient += S.transpose() * s.gradient_s + V.transpose() * s.gradient_v;
    whole.residuals.segment(r, s.residuals.size()) = s.residuals;
    whole.residual_jacobian.middleRows(r, s.residuals.size()) =
        s.residuals_s * S + s.residuals_v * V;
    r += s.residuals.size();
    whole.constraints.segment(c, s.constraints.size()) = s.constraints;
    whole.constraint_jacobian.middleRows(c, s.constraints.size()) =
        s.constraints_s * S + s.constraints_v * V;
    c += s.constraints.size();
    if (k + 1 < stages.stages.size()) S = (s.A * S + s.B * V).eval();
  }
  whole.gradient += whole.residual_jacobian.transpose() * whole.residuals;
  return whole;
}

/// The path problem with costs of inputs and of their changes.
Problem path_with_inputs() {
  ProblemDefinition d = path_problem().problem.definition();
  const InputLimits& limits = d.model->limits();
  d.terms.push_back({std::make_shared<ControlEffort>(Eigen::Vector2d(0.5, 0.1), limits), 0.3});
  d.terms.push_back({std::make_shared<InputRate>(limits), 0.7});
  return Problem(d);
}

Eigen::VectorXd inputs_of(const Problem& problem) {
  Eigen::VectorXd z = 0.5 * (problem.lower() + problem.upper());
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    z[i] += 0.2 * (problem.upper()[i] - problem.lower()[i]) *
            std::sin(1.7 * static_cast<double>(i) + 0.4);
  }
  return z;
}

TEST(StageStructure, ChainedIsTheProblemToFirstOrder) {
  const Problem problem = path_with_inputs();
  const Eigen::VectorXd z = inputs_of(problem);
  const StageStructure stages = stage_structure(problem, z);
  ASSERT_EQ(stages.stages.size(), 21U);
  EXPECT_TRUE(stages.by_gradient.empty());
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kResiduals, workspace, e));
  const Whole whole = chained(problem, stages);
  EXPECT_NEAR(stages.cost, e.cost[0], 1e-12);
  EXPECT_NEAR(stages.offset + 0.5 * whole.residuals.squaredNorm(), e.cost[0], 1e-12);
  EXPECT_TRUE(whole.gradient.isApprox(e.gradient, 1e-10));
  // The same rows in another order: the products are alike.
  EXPECT_TRUE((whole.residual_jacobian.transpose() * whole.residual_jacobian)
                  .isApprox(e.residual_jacobian.transpose() * e.residual_jacobian, 1e-10));
  // One row a node, so the order is that of the term.
  EXPECT_TRUE(whole.constraints.isApprox(e.constraints.col(0), 1e-12));
  EXPECT_TRUE(whole.constraint_jacobian.isApprox(e.jacobian, 1e-10));
}

TEST(StageStructure, KnotsDecideWhereTheyBegin) {
  const Problem problem = path_with_inputs();  // N = 20, M = 10
  const StageStructure stages = stage_structure(problem, inputs_of(problem));
  for (std::size_t k = 0; k < 21; ++k) {
    const Stage& s = stages.stages[k];
    EXPECT_EQ(s.decides, k < 20 && k % 2 == 0) << k;
    if (!s.decides && k < 20) {
      EXPECT_TRUE(s.B.isZero(0.0));
      EXPECT_TRUE(s.residuals_v.isZero(0.0));
    }
  }
}

TEST(StageStructure, CostsThatCoupleStagesAreInTheGradient) {
  const Problem problem = make_r1(Eigen::Vector3d::Zero());
  const Eigen::VectorXd z = inputs_of(problem);
  const StageStructure stages = stage_structure(problem, z);
  Workspace workspace = problem.make_workspace();
  Evaluation e;
  ASSERT_TRUE(problem.evaluate(z, Evaluate::kGradient, workspace, e));
  EXPECT_NEAR(stages.cost, e.cost[0], 1e-9 * std::abs(e.cost[0]));
  EXPECT_TRUE(chained(problem, stages).gradient.isApprox(e.gradient, 1e-9));
}

TEST(StageStructure, GapsAreThoseOfTheStatesGiven) {
  const Problem problem = path_with_inputs();
  const Eigen::VectorXd z = inputs_of(problem);
  const TrajectoryBatch t = problem.rollout(z);
  Eigen::MatrixXd states(3, 21);
  for (int k = 0; k <= 20; ++k) {
    for (int i = 0; i < 3; ++i) states(i, k) = t.x(k, i, 0);
  }
  states(1, 7) += 0.25;
  const StageStructure stages = stage_structure(problem, z, states);
  EXPECT_NEAR(stages.stages[6].gap[1], -0.25, 1e-12);
  EXPECT_NEAR(stages.stages[7].gap[1], 0.25, 1e-12);
  EXPECT_TRUE(stages.stages[5].gap.isZero(1e-12));
  EXPECT_TRUE(stages.stages[8].gap.isZero(1e-12));
}

TEST(StageStructure, RefusesOtherSizes) {
  const Problem problem = path_with_inputs();
  EXPECT_THROW(stage_structure(problem, Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(stage_structure(problem, inputs_of(problem), Eigen::MatrixXd::Zero(3, 5)),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::stage_structure_test
