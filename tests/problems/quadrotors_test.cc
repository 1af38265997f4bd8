// SPDX-License-Identifier: Apache-2.0
#include "problems/quadrotors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "problems/euler_quadrotors.h"

namespace prospect::quadrotors_test {
namespace {

/// hover + 3 sin(k + 2 i + 3 one) of rotor i of a quadrotor in stage k.
Eigen::VectorXd swinging(const Problem& problem) {
  Eigen::VectorXd z = quad_hovering(problem);
  const int nu = problem.horizon().nu();
  for (int k = 0; k < problem.horizon().N; ++k) {
    for (int j = 0; j < nu; ++j) z[k * nu + j] += 3.0 * std::sin(k + 2 * (j % 4) + 3 * (j / 4));
  }
  return z;
}

struct Case {
  const char* name;
  Problem problem;
  double hovering, swinging;  // costs
  double nearest;             // to a cylinder or another one, squared, beyond what is allowed [m^2]
  const char* constraint;
};

/// The costs and distances are those of the scripts of the source, run with NumPy.
std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"nav", quad_nav_circle(std::numbers::pi / 4.0), 30.0 * 32.0, 1203.88499607,
                 1.01209547796, "outside cylinders"});
  all.push_back({"track", quad_track_avoid(1.5, 2.0), 2908.53015761, 3387.73469358, 0.575186556749,
                 "outside cylinders"});
  all.push_back(
      {"swap", quad_multi_swap(4), 30.0 * 4.0 * 36.0, 4530.05350346, -0.508130560107, "apart"});
  return all;
}

TEST(Quadrotors, CostWhatTheScriptsOfTheirSourceSay) {
  EXPECT_NEAR(EulerQuadrotors::hover(), 522.9847140714692, 1e-9);
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const double hovering = one.problem.explain(quad_hovering(one.problem)).cost;
    EXPECT_NEAR(hovering, one.hovering, 1e-9 * one.hovering);
    const Explanation told = one.problem.explain(swinging(one.problem));
    EXPECT_NEAR(told.cost, one.swinging, 1e-9 * one.swinging);
    const auto term = std::find_if(told.terms.begin(), told.terms.end(),
                                   [&](const TermValue& t) { return t.name == one.constraint; });
    ASSERT_NE(term, told.terms.end());
    EXPECT_NEAR(term->raw, one.nearest, 1e-9);
  }
}

TEST(Quadrotors, HaveTheDerivativesOfDifferences) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const Problem& problem = one.problem;
    Workspace workspace = problem.make_workspace();
    Evaluation e, low, high;
    const Eigen::VectorXd z = swinging(problem);
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kGradient, workspace, e));
    const double steepest = e.gradient.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      const Eigen::VectorXd step = Eigen::VectorXd::Unit(z.size(), i) * 1e-3;
      ASSERT_TRUE(problem.evaluate(z - step, Evaluate::kValue, workspace, low));
      ASSERT_TRUE(problem.evaluate(z + step, Evaluate::kValue, workspace, high));
      EXPECT_NEAR((high.cost[0] - low.cost[0]) / 2e-3, e.gradient[i], 1e-6 * steepest) << i;
      const Eigen::VectorXd slope = (high.constraints.col(0) - low.constraints.col(0)) / 2e-3;
      const double off = (slope - e.jacobian.col(i)).cwiseAbs().maxCoeff();
      EXPECT_LE(off, 1e-6 * std::max(1.0, slope.cwiseAbs().maxCoeff())) << i;
    }
    ASSERT_TRUE(problem.evaluate(z, Evaluate::kResiduals, workspace, low));
    EXPECT_NEAR(low.residual_offset + 0.5 * low.residuals.squaredNorm(), e.cost[0],
                1e-11 * e.cost[0]);
    const Eigen::VectorXd gradient = low.residual_jacobian.transpose() * low.residuals;
    EXPECT_LE((gradient - e.gradient).cwiseAbs().maxCoeff(), 1e-9 * steepest);
  }
}

TEST(Quadrotors, OfTheTrackBeginOutsideOfTheCylinders) {
  EXPECT_FALSE(quad_track_begins_free(std::numbers::pi / 4.0));
  EXPECT_TRUE(quad_track_begins_free(2.0));
}

}  // namespace
}  // namespace prospect::quadrotors_test
