// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "solvers/hybrid/neighbour.h"
#include "solvers/hybrid/spread_candidates.h"
#include "solvers/registry.h"
#include "tests/solvers/problem_zoo.h"

namespace prospect::hybrid_test {
namespace {

using zoo::Case;

using zoo::Vector;
using zoo::Watch;

class Hybrid : public testing::Test {
 protected:
  void SetUp() override {
    const std::string why = solver_->explain_unsupported(zoo::camel().problem());
    if (!why.empty()) GTEST_SKIP() << why;
  }
  Result solve(const Problem& problem, const Vector& start, const Options& options = {}) const {
    WarmStart warm;
    warm.x = start;
    return solver_->solve(problem, warm, options, {});
  }
  std::shared_ptr<const Solver> solver_ = make_solver("hybrid");
};

/// x^2 + 10 (1 - cos 3x) a variable: minima all over, the only good one at zero.
Case ripples() {
  Case c{"ripples", Vector::Constant(2, -5), Vector::Constant(2, 4), Vector::Constant(2, 4)};
  c.f = [](const Vector& x) {
    return x.squaredNorm() + 10.0 * (1.0 - (3.0 * x.array()).cos()).sum();
  };
  c.g = [](const Vector& x) { return Vector(2.0 * x.array() + 30.0 * (3.0 * x.array()).sin()); };
  return c;
}

TEST(SpreadCandidates, FillTheBoxAndReachItsBounds) {
  const PathProblem path = path_problem();
  const Eigen::MatrixXd Z = spread_candidates(path.problem, 600, 4);
  ASSERT_EQ(Z.cols(), 600);
  EXPECT_EQ(Z.col(0), Vector::Zero(20));
  for (int i = 0; i < 20; ++i) {
    const double lower = path.problem.lower()[i], upper = path.problem.upper()[i];
    EXPECT_GE(Z.row(i).minCoeff(), lower);
    EXPECT_LE(Z.row(i).maxCoeff(), upper);
    // A sixth on each bound, and of the four sixths between as many in each quarter.
    EXPECT_NEAR((Z.row(i).array() == upper).count(), 100, 15);
    EXPECT_NEAR((Z.row(i).array() == lower).count(), 100, 15);
    for (int q = 0; q < 4; ++q) {
      const double a = lower + 0.25 * q * (upper - lower), b = a + 0.25 * (upper - lower);
      EXPECT_NEAR((Z.row(i).array() > a && Z.row(i).array() < b).count(), 100, 15);
    }
  }
  for (Eigen::Index c = 0; c < Z.cols(); ++c) {
    int changes = 0;
    for (int m = 1; m < 10; ++m) {
      changes += Z.col(c).segment<2>(2 * m) != Z.col(c).segment<2>(2 * m - 2);
    }
    EXPECT_LE(changes, 3);
  }
  EXPECT_EQ(spread_candidates(path.problem, 0, 4).cols(), 0);
  EXPECT_EQ(spread_candidates(path.problem, 7, 100).cols(), 7);
  EXPECT_EQ(spread_candidates(zoo::rosenbrock().problem(), 3, 4).rows(), 2);
}

TEST(Neighbour, ReplacesOneStretchByAConstant) {
  const PathProblem path = path_problem();
  const Problem& problem = path.problem;
  const Vector z = 0.3 * problem.upper() + 0.7 * problem.lower();
  Eigen::MatrixXd Z(20, 600);
  for (int i = 0; i < 600; ++i) Z.col(i) = neighbour(problem, z, i + 1);
  Eigen::ArrayXi lengths = Eigen::ArrayXi::Zero(11), replaced = Eigen::ArrayXi::Zero(10);
  int on_upper = 0, on_lower = 0;
  for (Eigen::Index c = 0; c < Z.cols(); ++c) {
    std::vector<int> knots;
    for (int m = 0; m < 10; ++m) {
      if (Z.col(c).segment<2>(2 * m) != z.segment<2>(2 * m)) knots.push_back(m);
    }
    ASSERT_FALSE(knots.empty());
    const auto length = static_cast<int>(knots.size());
    EXPECT_EQ(knots.back() - knots.front() + 1, length);
    for (const int m : knots) {
      EXPECT_EQ(Z.col(c).segment<2>(2 * m), Z.col(c).segment<2>(2 * knots.front()));
      ++replaced[m];
    }
    ++lengths[length];
    const int first = 2 * knots.front();
    on_upper += Z(first, c) == problem.upper()[first];
    on_lower += Z(first, c) == problem.lower()[first];
  }
  // All lengths alike, every knot often, a sixth of the constants on each bound.
  EXPECT_GE(lengths.tail(10).minCoeff(), 50);
  EXPECT_LE(lengths.maxCoeff(), 70);
  EXPECT_GE(replaced.minCoeff(), 150);
  EXPECT_NEAR(on_upper, 100, 15);
  EXPECT_NEAR(on_lower, 100, 15);
  EXPECT_TRUE((Z.array() <= problem.upper().replicate(1, 600).array()).all());
  EXPECT_TRUE((Z.array() >= problem.lower().replicate(1, 600).array()).all());
}

TEST_F(Hybrid, LeavesTheBasinOfItsStart) {
  for (const Case& c : {zoo::camel(), ripples()}) {
    SCOPED_TRACE(c.name);
    const Problem problem = c.problem();
    WarmStart warm;
    warm.x = c.start;
    const Result local = make_solver("nlopt")->solve(problem, warm, {}, {});
    EXPECT_GT(local.cost, c.optimum + 0.1);
    const Result r = solve(problem, c.start);
    EXPECT_NEAR(r.cost, c.optimum, 1e-6);
    EXPECT_EQ(r.stop, StopReason::kConverged);
    EXPECT_EQ(r.quality, Quality::kFeasibleOptimum);
  }
}

TEST_F(Hybrid, TakesTheSeedsItIsGiven) {
  const Case c = ripples();
  const auto watch = std::make_shared<Watch>();
  watch->record = true;
  const Problem problem = zoo::watched(c.problem(), watch);
  WarmStart warm;
  warm.x = c.start;
  warm.seeds.resize(2, 2);
  warm.seeds << 0.1, 9.0, -0.2, -9.0;  // the second is clamped
  const Result r = solver_->solve(problem, warm, {{"basins", 1}, {"max_evaluations", 40}}, {});
  ASSERT_GE(watch->points.size(), 4U);
  EXPECT_EQ(watch->points[0], c.start);
  EXPECT_EQ(watch->points[1], vec({0.1, -0.2}));
  EXPECT_EQ(watch->points[2], vec({4.0, -5.0}));
  // None of its own besides: polishing begins, at the best of the three.
  EXPECT_EQ(watch->points[3], watch->points[1]);
  EXPECT_NEAR(r.cost, 0.0, 1e-6);
}

// Measured by its bounds this start is where the best seed is, and it scores worse.
TEST_F(Hybrid, PolishesTheStartItIsGiven) {
  Case c{"two wells", vec({-1000.0}), vec({1000.0}), vec({2.5})};
  c.f = [](const Vector& x) { return 10.0 * std::pow(x[0] * (x[0] - 2.0), 2) - 0.1 * x[0]; };
  c.g = [](const Vector& x) {
    return Vector::Constant(1, 40.0 * x[0] * (x[0] - 2.0) * (x[0] - 1.0) - 0.1);
  };
  const auto watch = std::make_shared<Watch>();
  watch->record = true;
  WarmStart warm;
  warm.x = c.start;
  warm.seeds.resize(1, 3);
  warm.seeds << 0.0, -300.0, 400.0;
  const Result r = solver_->solve(zoo::watched(c.problem(), watch), warm, {}, {});
  EXPECT_NEAR(r.cost, -0.2, 1e-3);
  // Once to be scored, once to begin.
  EXPECT_EQ(std::count(watch->points.begin(), watch->points.end(), c.start), 2);
}

TEST_F(Hybrid, RefusesSeedsThatDoNotFit) {
  const Problem problem = ripples().problem();
  WarmStart warm;
  warm.seeds = Eigen::MatrixXd::Zero(3, 5);
  Result r = solver_->solve(problem, warm, {}, {});
  EXPECT_EQ(r.stop, StopReason::kError);
  EXPECT_THAT(r.detail, testing::HasSubstr("warm_start.seeds is 3 x 5; expected 2 finite rows"));
  warm.seeds = Eigen::MatrixXd::Constant(2, 1, std::nan(""));
  r = solver_->solve(problem, warm, {}, {});
  EXPECT_EQ(r.stop, StopReason::kError);
}

TEST_F(Hybrid, PolishesWithWhatItIsTold) {
  const Case c = ripples();
  for (const SolverInfo& info : list_solvers()) {
    if (!info.available || info.name.find(":LD_") == std::string::npos) continue;
    const Result r = solve(c.problem(), c.start, {{"polish", info.name}});
    EXPECT_NEAR(r.cost, 0.0, 1e-5) << info.name << ": " << r.detail;
  }
  const auto detail = [&](const Options& options) {
    const Result r = solve(c.problem(), c.start, options);
    EXPECT_EQ(r.stop, StopReason::kError);
    return r.detail;
  };
  EXPECT_THAT(detail({{"polish", std::string("nlopt:LD_SLQP")}}),
              testing::HasSubstr("'nlopt:LD_SLSQP'"));
  EXPECT_THAT(detail({{"polish", std::string("hybrid")}}), testing::HasSubstr("other than this"));
  EXPECT_THAT(detail({{"basins", 0}}), testing::HasSubstr("1 to"));
  EXPECT_THAT(detail({{"patience", -1}}), testing::HasSubstr("0 to"));
  EXPECT_THAT(detail({{"separation", -0.1}}), testing::HasSubstr("0 or more"));
  EXPECT_THAT(detail({{"polish_tolerance", 2.0}}), testing::HasSubstr("0 to 1"));
}

TEST_F(Hybrid, SharesASmallBudget) {
  // Seeds take half at most, so that some are left to polish with.
  const Case c = zoo::hs43();
  for (const int budget : {10, 30, 60, 120}) {
    const auto watch = std::make_shared<Watch>();
    watch->record = true;
    const Result r =
        solve(zoo::watched(c.problem(), watch), c.start, {{"max_evaluations", budget}});
    EXPECT_LE(r.counters.cost_evaluations, budget);
    EXPECT_GE(r.counters.gradient_evaluations, budget / 5);
    EXPECT_LE(r.cost, c.f(c.start));
    EXPECT_LE(r.violation, 1e-6);
  }
}

TEST_F(Hybrid, SearchesNearTheIncumbentUntilTurnsGainNothing) {
  const Case c = ripples();
  WarmStart warm;
  warm.x = c.start;
  const auto search = [&](int patience, const StopCondition& stop = {}) {
    return solver_->solve(c.problem(), warm, {{"candidates", 1}, {"patience", patience}}, stop);
  };
  const double local = make_solver("sqp")->solve(c.problem(), warm, {}, {}).cost;
  const Result brief = search(0), usual = search(6), patient = search(60);
  EXPECT_LE(brief.cost, local);
  EXPECT_LT(usual.cost, local - 1.0);
  EXPECT_NEAR(patient.cost, 0.0, 1e-6);
  EXPECT_LT(brief.counters.cost_evaluations, usual.counters.cost_evaluations);
  // Two starts in each of 61 turns at least, after the first.
  EXPECT_GE(patient.counters.iterations, 61);
  // Time enough changes nothing.
  const Result timed = search(6, deadline(1e6));
  EXPECT_EQ(timed.x, usual.x);
  EXPECT_EQ(timed.counters.cost_evaluations, usual.counters.cost_evaluations);
}

TEST_F(Hybrid, HasTheSameBitsOnTwoThreads) {
  const PathProblem path = path_problem();
  const Result one = solve(path.problem, Vector::Constant(20, 0.6));
  const Result two = solve(path.problem, Vector::Constant(20, 0.6), {{"threads", 2}});
  EXPECT_EQ(one.x, two.x);
  EXPECT_EQ(one.counters.cost_evaluations, two.counters.cost_evaluations);
  EXPECT_EQ(one.detail, two.detail);
}

// By 5 ms, scores of seeds took two of them, and the best was not polished to its end.
TEST_F(Hybrid, InAHurryTheFirstSeedsHaveToDo) {
  const Case c = ripples();
  WarmStart warm;
  warm.x = c.start;
  warm.seeds.resize(2, 20);
  for (int s = 0; s < 20; ++s) warm.seeds.col(s) = vec({-4.0 + 0.4 * s, 3.0 - 0.3 * s});
  const auto scored = [&](const StopCondition& stop) {
    const auto watch = std::make_shared<Watch>();
    watch->record = true;
    const Problem problem = zoo::watched(c.problem(), watch);
    const Result r = solver_->solve(problem, warm, {}, stop);
    EXPECT_GT(r.counters.gradient_evaluations, 0);
    int n = 0;
    while (n < 20 && watch->points[1 + n] == warm.seeds.col(n)) ++n;
    return n;
  };
  // As above: its time is over, but it is not stopped.
  const StopCondition over([] { return StopRequest::kNone; }, seconds_by(SolveClock::kWall));
  EXPECT_EQ(scored(over), 8);
  EXPECT_EQ(scored(deadline(1e6)), 20);
  EXPECT_EQ(scored({}), 20);
}

TEST_F(Hybrid, StaysFeasibleAndSolvesWithConstraints) {
  // A wall of discs before a path: the best input of many seeds that violate them.
  const PathProblem path = path_problem();
  const Result r = solve(path.problem, Vector::Constant(20, 0.6));
  EXPECT_LE(r.violation, 1e-6);
  EXPECT_LE(r.cost, 1e-5) << r.detail;
}

}  // namespace
}  // namespace prospect::hybrid_test
