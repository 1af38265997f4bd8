// SPDX-License-Identifier: Apache-2.0
// What tests/solvers/contract_test.cc does not ask of every back end.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

#include "problems/path_problem.h"
#include "problems/r1.h"
#include "solvers/registry.h"
#include "tests/solvers/problem_zoo.h"

namespace prospect::sqp_test {
namespace {

using zoo::Matrix;
using zoo::Vector;

Result solve(const Problem& problem, const Vector& x, const Options& options = {}) {
  WarmStart from;
  from.x = x;
  return make_solver("sqp")->solve(problem, from, options, {});
}

TEST(Sqp, TakesFewEvaluationsOnATrajectory) {
  const PathProblem path = path_problem();
  const Result r = solve(path.problem, Vector::Zero(20));
  EXPECT_EQ(r.quality, Quality::kFeasibleOptimum) << r.detail;
  EXPECT_LE(r.cost, 1e-5);
  EXPECT_LE(r.counters.cost_evaluations, 40);
}

TEST(Sqp, LiftedStartFindsMostOfS30) {
  const std::vector<Eigen::Vector3d> starts = r1_starts(17, 30);
  int solved = 0, solved_lifted = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const Problem problem = make_r1(starts[i]);
    const double best = s30_best_known()[i];
    solved += r1_solved(solve(problem, r1_cold()).cost, best);
    const Result lifted = solve(problem, r1_cold(), {{"lifted", 8}});
    EXPECT_EQ(lifted.quality, Quality::kFeasibleOptimum) << lifted.detail;
    // What is returned is a rollout.
    EXPECT_EQ(lifted.cost, problem.explain(lifted.x).cost);
    solved_lifted += r1_solved(lifted.cost, best);
  }
  EXPECT_GE(solved, 14);
  EXPECT_GE(solved_lifted, 22);
}

TEST(Sqp, EndsWhereTheConstraintsAreLeastViolated) {
  // x0 >= 1 + x1^2 and x0 <= -1 - x1^2: no point is feasible, and (0, 0) misses by 1.
  zoo::Case c{"apart", vec({-3, -3}), vec({3, 3}), vec({2, 2})};
  c.f = [](const Vector& x) { return x.squaredNorm(); };
  c.g = [](const Vector& x) { return Vector(2 * x); };
  c.rows = 2;
  c.c = [](const Vector& x) { return vec({x[0] - 1 - x[1] * x[1], -x[0] - 1 - x[1] * x[1]}); };
  c.J = [](const Vector& x) {
    Matrix J(2, 2);
    J << 1, -2 * x[1], -1, -2 * x[1];
    return J;
  };
  const Result r = solve(c.problem(), c.start);
  EXPECT_EQ(r.quality, Quality::kInfeasible);
  EXPECT_NEAR(r.violation, 1.0, 1e-4);
}

TEST(Sqp, GoesOnWithTheCurvatureOfItsResult) {
  const Problem problem = make_r1();
  const Result first = solve(problem, r1_cold(), {{"max_evaluations", 15}});
  ASSERT_EQ(first.next.stage_hessians.cols(), 3 * 21);
  WarmStart without = first.next;
  without.stage_hessians.resize(0, 0);
  const auto evaluations = [&](const WarmStart& from) {
    const Result r = make_solver("sqp")->solve(problem, from, {{"trace", 1}}, {});
    EXPECT_EQ(r.quality, Quality::kFeasibleOptimum) << r.detail;
    // Until something is better than the start.
    return r.trace.size() > 1 ? r.trace[1].evaluations : 1000;
  };
  // A step at once, instead of after differences of three states.
  EXPECT_LE(evaluations(first.next) + 2, evaluations(without));
}

// A fixed floor under the curvature of the stages makes steps in a flat valley that promise less
// than the tolerance far from its minimum.
TEST(Sqp, ReachesTheEndOfAFlatValley) {
  const PathProblem path = path_problem();
  const Result r = make_solver("sqp")->solve(path.problem, {}, {}, {});
  EXPECT_EQ(r.quality, Quality::kFeasibleOptimum);
  EXPECT_LE(r.cost, 1e-7);
}

TEST(Sqp, TakesVariablesInUnitsFarApart) {
  for (const auto& c : zoo::badly_scaled()) {
    SCOPED_TRACE(c.name);
    WarmStart warm;
    warm.x = c.start;
    const Result r = make_solver("sqp")->solve(c.problem(), warm, {}, {});
    EXPECT_EQ(r.quality, Quality::kFeasibleOptimum) << r.detail;
    EXPECT_NEAR(r.cost, c.optimum, 1e-6 * std::max(1.0, std::abs(c.optimum)));
    EXPECT_LE(r.counters.cost_evaluations, 20);
  }
}

}  // namespace
}  // namespace prospect::sqp_test
