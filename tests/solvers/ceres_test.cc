// SPDX-License-Identifier: Apache-2.0
// What the ceres back end promises beyond the contract of all (contract_test.cc).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "problems/r1.h"
#include "problems/zoo.h"
#include "solvers/registry.h"

namespace prospect::ceres_test {
namespace {

class Ceres : public testing::Test {
 protected:
  void SetUp() override {
    for (const SolverInfo& info : list_solvers()) {
      if (info.name == "ceres" && !info.available) GTEST_SKIP() << "Ceres is not built in";
    }
  }
  std::shared_ptr<const Solver> solver_ = make_solver("ceres");
};

TEST_F(Ceres, NamesTheTermsThatAreNoSumOfSquares) {
  FunctionProblem p = zoo::hs76();
  p.residuals.reset();
  const Problem problem = p.problem();
  EXPECT_THAT(solver_->explain_unsupported(problem), testing::HasSubstr("'function'"));
  const Result r = solver_->solve(problem, {}, {}, {});
  EXPECT_EQ(r.stop, StopReason::kError);
  EXPECT_THAT(r.detail, testing::HasSubstr("no residual form"));
  // As the polish of another back end too.
  const Result hybrid =
      make_solver("hybrid")->solve(problem, {}, {{"polish", std::string("ceres")}}, {});
  EXPECT_EQ(hybrid.stop, StopReason::kError);
  EXPECT_THAT(hybrid.detail, testing::HasSubstr("ceres: no residual form"));
}

TEST_F(Ceres, NeedsOneEvaluationForCostResidualsAndJacobian) {
  const FunctionProblem p = zoo::rosenbrock();
  WarmStart start;
  start.x = p.start;
  const Result r = solver_->solve(p.problem(), start, {}, {});
  EXPECT_EQ(r.counters.cost_evaluations, r.counters.gradient_evaluations);
  EXPECT_LE(r.counters.cost_evaluations, 100);  // from zero, with curvature from the first step
  EXPECT_LE(r.cost, 1e-10);
}

TEST_F(Ceres, SolvesALinearLeastSquaresProblemWithBoundsInAFewSteps) {
  const FunctionProblem p = zoo::bounded_quadratic();
  WarmStart start;
  start.x = p.start;
  const Result r = solver_->solve(p.problem(), start, {}, {});
  EXPECT_NEAR(r.cost, p.optimum, 1e-9);
  EXPECT_LE(r.counters.cost_evaluations, 12);
}

TEST_F(Ceres, PolishesForHybrid) {
  WarmStart cold;
  cold.x = r1_cold();
  const Problem problem = make_r1();
  const Result alone = solver_->solve(problem, cold, {}, {});
  const Result r =
      make_solver("hybrid")->solve(problem, cold, {{"polish", std::string("ceres")}}, {});
  EXPECT_EQ(r.quality, Quality::kFeasibleOptimum) << r.detail;
  EXPECT_LE(r.cost, alone.cost + 1e-3);
}

TEST_F(Ceres, RefusesOptionsOutOfRange) {
  const FunctionProblem p = zoo::hs76();
  for (const char* name : {"initial_penalty", "barrier", "barrier_width",
                           "barrier_trust_region_radius", "initial_trust_region_radius"}) {
    const Result r = solver_->solve(p.problem(), {}, {{name, 0.0}}, {});
    EXPECT_EQ(r.stop, StopReason::kError);
    EXPECT_THAT(r.detail,
                testing::HasSubstr(std::string(name) + "' is 0; expected a number above"));
  }
}

}  // namespace
}  // namespace prospect::ceres_test
