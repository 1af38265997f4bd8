// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "solvers/registry.h"
#include "solvers/sampling/cross_entropy.h"
#include "solvers/sampling/path_integral.h"
#include "solvers/sampling/pattern_search.h"
#include "solvers/sampling/rate_projection.h"
#include "solvers/sampling/systematic_search.h"
#include "tests/solvers/problem_zoo.h"

namespace prospect::sampling_test {
namespace {

using zoo::Matrix;

using zoo::Vector;
using zoo::Watch;

/// The largest excess over the rate limits, straight from the definition.
double rate_excess(const Problem& problem, const Vector& z) {
  const ProblemDefinition& d = problem.definition();
  const Eigen::Index nu = d.u_previous.size();
  double excess = 0.0;
  for (Eigen::Index m = 0; m < d.M; ++m) {
    for (Eigen::Index j = 0; j < nu; ++j) {
      const double before = m == 0 ? d.u_previous[j] : z[(m - 1) * nu + j];
      excess =
          std::max(excess, std::abs(z[m * nu + j] - before) - d.model->limits().rate[j] * d.dt);
    }
  }
  return excess;
}

TEST(RateProjection, MakesInputsKeepTheLimitsAndLeavesThoseThatDo) {
  const PathProblem path = path_problem();
  const RateProjection rate(path.problem);
  ASSERT_TRUE(rate.active());
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  int violated = 0;
  for (int i = 0; i < 200; ++i) {
    Vector z = Vector::NullaryExpr(20, [&] { return uniform(generator); });
    if (rate_excess(path.problem, z) > 0.1) ++violated;
    rate.apply(z);
    EXPECT_LE(rate_excess(path.problem, z), 1e-12);
    EXPECT_TRUE((z.array() >= path.problem.lower().array()).all());
    EXPECT_TRUE((z.array() <= path.problem.upper().array()).all());
    const Vector once = z;
    rate.apply(z);
    EXPECT_EQ(z, once);
  }
  EXPECT_EQ(violated, 200);
  Vector solution = path.solution;
  rate.apply(solution);
  EXPECT_EQ(solution, path.solution);
}

TEST(RateProjection, IsIdleWithoutLimits) {
  const Problem problem = zoo::hs43().problem();
  const RateProjection rate(problem);
  EXPECT_FALSE(rate.active());
  Vector z = vec({9, -9, 9, -9});
  rate.apply(z);
  EXPECT_EQ(z, vec({9, -9, 9, -9}));
}

TEST(SystematicSearch, HoldsEveryConstantAndEverySwitch) {
  const PathProblem path = path_problem();
  const Matrix Z = systematic_candidates(path.problem, 1000);
  EXPECT_LE(Z.cols(), 1000);
  EXPECT_GE(Z.cols(), 500);
  int constants = 0, pairs = 0;
  bool stop = false, full_ahead = false;
  for (Eigen::Index c = 0; c < Z.cols(); ++c) {
    EXPECT_TRUE((Z.col(c).array() >= path.problem.lower().array()).all());
    EXPECT_TRUE((Z.col(c).array() <= path.problem.upper().array()).all());
    int changes = 0;
    for (int m = 1; m < 10; ++m) {
      changes += Z.col(c).segment<2>(2 * m) != Z.col(c).segment<2>(2 * m - 2);
    }
    EXPECT_LE(changes, 1);
    (changes == 0 ? constants : pairs) += 1;
    stop = stop || (Z.col(c).array() == 0.0).all();
    full_ahead = full_ahead || (changes == 0 && Z(0, c) == path.problem.upper()[0] && Z(1, c) == 0);
    for (Eigen::Index other = 0; other < c; ++other) EXPECT_NE(Z.col(c), Z.col(other));
  }
  EXPECT_EQ(constants, 15 * 15);  // the finest square grid in a quarter of 1000
  EXPECT_EQ(pairs, 3 * 16 * 15);  // 4 x 4 levels, another 4 x 4 less the same, three switches
  EXPECT_TRUE(stop);
  EXPECT_TRUE(full_ahead);
}

TEST(SystematicSearch, FillsTheBoxWhereAGridIsTooCoarse) {
  const zoo::Case c = zoo::bounded_quadratic();  // ten inputs, one knot
  const Problem problem = c.problem();
  const Matrix Z = systematic_candidates(problem, 500);
  ASSERT_EQ(Z.cols(), 500);
  for (int i = 0; i < 10; ++i) {
    // Each tenth of each range gets a tenth of the points, give or take a fifth; of 100 such counts
    // of random points the worst is usually a third off.
    for (int tenth = 0; tenth < 10; ++tenth) {
      const double a = -1 + 0.2 * tenth;
      const auto inside = ((Z.row(i).array() >= a) && (Z.row(i).array() < a + 0.2)).count();
      EXPECT_NEAR(static_cast<double>(inside), 50.0, 10.0) << i << " " << tenth;
    }
  }
  for (const int most : {0, 1, 2, 3, 17}) {
    EXPECT_LE(systematic_candidates(problem, most).cols(), most);
    EXPECT_LE(systematic_candidates(path_problem().problem, most).cols(), most);
  }
}

TEST(PathIntegral, KeepsRateLimitsInEveryCandidate) {
  for (const char* name : {"sampling", "sampling:cem", "sampling:mppi", "sampling:search"}) {
    const auto watch = std::make_shared<Watch>();
    watch->record = true;
    PathProblem path = path_problem();
    path.problem = zoo::watched(path.problem, watch);
    WarmStart w;
    w.x = vec({0.3, 0}).replicate(10, 1);
    const Result r = make_solver(name)->solve(path.problem, w, {{"max_evaluations", 3000}}, {});
    EXPECT_LE(rate_excess(path.problem, r.x), 1e-9) << name;
    ASSERT_GE(watch->points.size(), 3000U);
    for (const Vector& stages : watch->points) {
      Vector z(20);
      for (int m = 0; m < 10; ++m) z.segment<2>(2 * m) = stages.segment<2>(4 * m);
      ASSERT_LE(rate_excess(path.problem, z), 1e-9) << name;
    }
    // Unless told otherwise.
    watch->points.clear();
    make_solver(name)->solve(path.problem, w, {{"max_evaluations", 500}, {"rate_feasible", 0}}, {});
    bool exceeded = false;
    for (const Vector& stages : watch->points) {
      Vector z(20);
      for (int m = 0; m < 10; ++m) z.segment<2>(2 * m) = stages.segment<2>(4 * m);
      exceeded = exceeded || rate_excess(path.problem, z) > 1e-3;
    }
    EXPECT_TRUE(exceeded) << name;
  }
}

TEST(PathIntegral, StaysFiniteOnFlatSteepAndBrokenCosts) {
  const std::vector<std::pair<std::string, FunctionCost::Value>> costs = {
      {"flat", [](const Vector&) { return 3.0; }},
      {"huge", [](const Vector& x) { return 1e18 * x.squaredNorm(); }},
      {"tiny", [](const Vector& x) { return 1e-300 * x.squaredNorm(); }},
      {"step", [](const Vector& x) { return x[0] > 0.3 ? 0.0 : 1.0; }},
      {"mostly undefined",
       [](const Vector& x) { return x[0] < 0.4 ? std::nan("") : x.squaredNorm(); }},
      {"offset", [](const Vector& x) { return 1e12 + x.squaredNorm(); }},
  };
  for (const auto& [name, f] : costs) {
    zoo::Case c = zoo::hs76();
    c.f = f;
    const auto watch = std::make_shared<Watch>();
    watch->record = true;
    const Problem problem = zoo::watched(c.problem(), watch);
    for (const char* solver : {"sampling", "sampling:cem", "sampling:mppi", "sampling:search"}) {
      WarmStart w;
      w.x = Vector::Constant(4, 0.5);
      const Result r = make_solver(solver)->solve(problem, w, {}, {});
      EXPECT_EQ(r.quality, Quality::kFeasible) << solver << ", " << name << ": " << r.detail;
      EXPECT_TRUE(std::isfinite(r.cost));
    }
    for (const Vector& x : watch->points) ASSERT_TRUE(x.allFinite()) << name;
  }
}

TEST(PathIntegral, FindsAFeasiblePointFromAnInfeasibleStart) {
  const zoo::Case c = zoo::hs22();
  ASSERT_GT(c.violation(c.start), 1.0);
  WarmStart w;
  w.x = c.start;
  for (const char* solver : {"sampling", "sampling:cem", "sampling:mppi", "sampling:search"}) {
    const Result r = make_solver(solver)->solve(c.problem(), w, {{"max_evaluations", 1500}}, {});
    EXPECT_LE(r.violation, 1e-6) << solver;
    EXPECT_LE(r.cost, 1.2) << solver;
  }
}

TEST(CrossEntropy, ConvergesOnABowlAndFollowsASlopeToItsEnd) {
  const zoo::Case c = zoo::bounded_quadratic();
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  EXPECT_TRUE(cross_entropy(e, RateProjection(problem), {}, 1e-3, c.start));
  EXPECT_NEAR(e.incumbent_cost(), c.optimum, 1e-3);

  // From one corner of the box to the other with a small sigma: it must grow on the way.
  zoo::Case slope = zoo::hs76();
  slope.rows = 0;
  slope.f = [](const Vector& x) { return x.sum(); };
  const Problem downhill = slope.problem();
  Evaluator d(downhill, {}, never);
  CrossEntropySettings small;
  small.sigma = 0.01;
  EXPECT_TRUE(cross_entropy(d, RateProjection(downhill), small, 1e-3, slope.upper));
  EXPECT_NEAR(d.incumbent_cost(), 0.0, 1e-6);
}

TEST(PatternSearch, ConvergesOnABowlFromTheIncumbent) {
  const zoo::Case c = zoo::bounded_quadratic();
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  e.evaluate(c.start, Evaluate::kValue);
  EXPECT_TRUE(pattern_search(e, RateProjection(problem), true, 0.1, 1e-5));
  EXPECT_NEAR(e.incumbent_cost(), c.optimum, 1e-9);
}

}  // namespace
}  // namespace prospect::sampling_test
