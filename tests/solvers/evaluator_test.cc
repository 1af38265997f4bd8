// SPDX-License-Identifier: Apache-2.0
#include "solvers/evaluator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/solvers/problem_zoo.h"

namespace prospect::evaluator_test {
namespace {

using zoo::Case;
using zoo::Matrix;

using zoo::Vector;
using zoo::Watch;

TEST(Evaluator, RemembersTheLastPoint) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  const StopCondition never;
  Evaluator e(problem, {}, never);
  const Vector x = vec({0.1, 0.2, 0.3, 0.4});
  EXPECT_EQ(e.evaluate(x, Evaluate::kGradient), EvaluationOutcome::kEvaluated);
  EXPECT_EQ(e.evaluate(x, Evaluate::kValue), EvaluationOutcome::kEvaluated);
  EXPECT_EQ(e.evaluate(x, Evaluate::kGradient), EvaluationOutcome::kEvaluated);
  EXPECT_EQ(watch->evaluations, 1);
  EXPECT_EQ(e.counters().cost_evaluations, 1);
  EXPECT_EQ(e.counters().gradient_evaluations, 1);
  EXPECT_EQ(e.cost(), c.f(x));
  EXPECT_EQ(e.constraints(), c.c(x));
  EXPECT_TRUE(e.gradient().isApprox(c.g(x), 1e-14));
  EXPECT_TRUE(e.jacobian().isApprox(c.J(x), 1e-14));
  // A value alone does not stand for a gradient.
  const Vector y = vec({0.4, 0.2, 0.3, 0.4});
  e.evaluate(y, Evaluate::kValue);
  EXPECT_EQ(e.cost(), c.f(y));
  e.evaluate(y, Evaluate::kGradient);
  EXPECT_EQ(watch->evaluations, 3);
  EXPECT_TRUE(e.gradient().isApprox(c.g(y), 1e-14));
}

TEST(Evaluator, ShowsOnlyTheFreeVariables) {
  Case c = zoo::hs43();
  c.lower[1] = c.upper[1] = 0.7;
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  ASSERT_EQ(e.num_variables(), 3);
  const Vector x = vec({0.1, 0.3, 0.4});
  const Vector z = vec({0.1, 0.7, 0.3, 0.4});
  EXPECT_EQ(e.expand(x), z);
  EXPECT_EQ(e.reduce(z), x);
  e.evaluate(x, Evaluate::kGradient);
  EXPECT_EQ(e.cost(), c.f(z));
  const Vector g = c.g(z);
  EXPECT_TRUE(e.gradient().isApprox(vec({g[0], g[2], g[3]}), 1e-14));
  const Matrix J = c.J(z);
  EXPECT_TRUE(e.jacobian().col(1).isApprox(J.col(2), 1e-14));
}

TEST(Evaluator, NeverEvaluatesAfterAStop) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  bool stop_now = false;
  const StopCondition stop([&] { return stop_now ? StopRequest::kDeadline : StopRequest::kNone; });
  Evaluator e(problem, {}, stop);
  e.evaluate(c.start, Evaluate::kValue);
  stop_now = true;
  EXPECT_EQ(e.evaluate(vec({1, 0, 0, 0}), Evaluate::kValue), EvaluationOutcome::kStopped);
  stop_now = false;  // a stop condition that changes its mind changes nothing
  EXPECT_EQ(e.evaluate(vec({1, 0, 0, 0}), Evaluate::kValue), EvaluationOutcome::kStopped);
  EXPECT_EQ(e.evaluate(c.start, Evaluate::kValue), EvaluationOutcome::kStopped);
  Eigen::ArrayXd cost, violations;
  EXPECT_EQ(e.evaluate_batch(Matrix::Zero(4, 5), cost, violations), 0);
  EXPECT_EQ(watch->evaluations, 1);
  EXPECT_TRUE(e.should_stop());
}

TEST(Evaluator, StopsABatchBetweenChunks) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  int asked = 0;
  const StopCondition stop(
      [&] { return ++asked > 2 ? StopRequest::kDeadline : StopRequest::kNone; });
  Evaluator e(problem, {}, stop);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Matrix X = Matrix::NullaryExpr(
      4, 5 * Evaluator::kChunk, [&](Eigen::Index, Eigen::Index) { return uniform(generator); });
  Eigen::ArrayXd cost, violations;
  ASSERT_EQ(e.evaluate_batch(X, cost, violations), 2 * Evaluator::kChunk);
  EXPECT_EQ(watch->evaluations, 2 * Evaluator::kChunk);
  for (Eigen::Index b = 0; b < X.cols(); ++b) {
    const bool done = b < 2 * Evaluator::kChunk;
    EXPECT_EQ(cost[b], done ? c.f(X.col(b)) : Problem::kRejectedCost);
    if (done) {
      EXPECT_EQ(violations[b], c.violation(X.col(b)));
    } else {
      EXPECT_TRUE(std::isinf(violations[b]));
    }
  }
}

TEST(Evaluator, KeepsABatchWithinMaxEvaluations) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  const StopCondition never;
  CommonOptions options;
  options.max_evaluations = Evaluator::kChunk + 3;
  Evaluator e(problem, options, never);
  Eigen::ArrayXd cost, violations;
  const Matrix X = Matrix::Zero(4, 3 * Evaluator::kChunk);
  EXPECT_EQ(e.evaluate_batch(X, cost, violations), Evaluator::kChunk + 3);
  EXPECT_EQ(watch->evaluations, Evaluator::kChunk + 3);
  EXPECT_TRUE(e.stopped());
}

/// A cost whose scores are off by its whole error, either way from point to point.
class RoughCost final : public Term {
 public:
  RoughCost(std::shared_ptr<const Term> cost, std::shared_ptr<Watch> watch)
      : cost_(std::move(cost)), watch_(std::move(watch)) {}
  std::string_view name() const override { return "rough"; }
  TermTraits traits() const override {
    TermTraits traits = cost_->traits();
    traits.scores = true;
    return traits;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch* scratch,
                TermOutput& out) const override {
    cost_->evaluate(t, request, scratch, out);
    if (!request.score) {
      if (watch_) watch_->evaluations += t.batch();
      return;
    }
    for (int b = 0; b < t.batch(); ++b) {
      const double value = out.value(0, b);
      const bool up = std::fmod(std::abs(1e6 * t.inputs(0, b)), 2.0) < 1.0;
      out.value(0, b) += (up ? 0.99 : -0.99) * kScoreError * std::max(1.0, std::abs(value));
    }
  }

 private:
  std::shared_ptr<const Term> cost_;
  std::shared_ptr<Watch> watch_;
};

TEST(Evaluator, ScoresChooseButTheIncumbentIsExact) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  ProblemDefinition d = c.problem().definition();
  d.terms.front().term = std::make_shared<RoughCost>(d.terms.front().term, watch);
  const Problem rough(d), exact = c.problem();
  const StopCondition never;
  std::mt19937_64 generator(9);
  // Spread out, where scores tell candidates apart, and so near to each other that none does.
  for (const double spread : {1.0, 1e-6}) {
    for (const double centre : {0.0, 3.0}) {  // feasible and not
      std::uniform_real_distribution<double> uniform(centre - spread, centre + spread);
      const Matrix X =
          Matrix::NullaryExpr(4, 20 * Evaluator::kChunk,
                              [&](Eigen::Index, Eigen::Index) { return uniform(generator); });
      Eigen::ArrayXd cost, violations, exact_cost, exact_violations;
      Evaluator e(rough, {}, never), reference(exact, {}, never);
      watch->evaluations = 0;
      ASSERT_EQ(e.evaluate_batch(X, cost, violations, Evaluate::kScore), X.cols());
      ASSERT_EQ(reference.evaluate_batch(X, exact_cost, exact_violations), X.cols());
      EXPECT_EQ(e.incumbent_cost(), c.f(e.incumbent()));
      EXPECT_EQ(e.incumbent_violation(), c.violation(e.incumbent()));
      EXPECT_EQ(e.incumbent_feasible(), reference.incumbent_feasible());
      const double error = kScoreError * std::max(1.0, std::abs(reference.incumbent_cost()));
      EXPECT_LE(e.incumbent_cost(), reference.incumbent_cost() + 2.0 * error);
      EXPECT_EQ(e.counters().cost_evaluations, X.cols());
      EXPECT_TRUE((violations == exact_violations).all());
      EXPECT_TRUE(((cost - exact_cost).abs() <= kScoreError * exact_cost.abs().max(1.0)).all());
      if (spread == 1.0) {
        EXPECT_LT(watch->evaluations, X.cols() / 8);
        EXPECT_TRUE((cost != exact_cost).any());
        EXPECT_EQ(e.incumbent(), reference.incumbent());
      } else {
        EXPECT_LE(watch->evaluations, X.cols());
      }
    }
  }
}

/// Not defined for inputs above 0.97: a term that throws there.
class ThrowingAbove final : public Term {
 public:
  explicit ThrowingAbove(std::shared_ptr<const Term> cost) : cost_(std::move(cost)) {}
  std::string_view name() const override { return "throwing"; }
  TermTraits traits() const override { return cost_->traits(); }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch* scratch,
                TermOutput& out) const override {
    if ((t.inputs.row(0) > 0.97).any()) throw std::domain_error("above");
    cost_->evaluate(t, request, scratch, out);
  }

 private:
  std::shared_ptr<const Term> cost_;
};

// Scores and exact values, solves that end by their budget, by a stop and by a term that throws.
TEST(Evaluator, AnyNumberOfThreadsGivesTheSameBits) {
  const Case c = zoo::hs43();
  ProblemDefinition d = c.problem().definition();
  d.terms.front().term = std::make_shared<RoughCost>(d.terms.front().term, nullptr);
  const Problem rough(d);
  d.terms.front().term = std::make_shared<ThrowingAbove>(d.terms.front().term);
  const Problem throwing(d);
  std::mt19937_64 generator(11);
  struct Run {
    int done;
    Eigen::ArrayXd cost, violations;
    Vector incumbent;
    double incumbent_cost;
    int evaluations;
    bool stopped;
  };
  for (const double spread : {1.0, 1e-6, 0.0}) {  // 0: all from better to worse, all from worse
    std::uniform_real_distribution<double> uniform(-0.9 - spread, -0.9 + spread);
    Matrix X = Matrix::NullaryExpr(4, 13 * Evaluator::kChunk + 5,
                                   [&](Eigen::Index, Eigen::Index) { return uniform(generator); });
    if (spread == 0.0) {
      for (Eigen::Index b = 0; b < X.cols(); ++b) X.col(b).setConstant(0.9 - 1e-3 * b);
      X(0, 150) = 0.99;
    }
    for (const int most : {10000, 7 * Evaluator::kChunk + 3}) {
      for (const int stops : {1000000, 9}) {
        for (const bool throws : {false, true}) {
          for (const Evaluate what : {Evaluate::kScore, Evaluate::kValue}) {
            std::vector<Run> runs;
            for (const int threads : {1, 2, 3, 7}) {
              CommonOptions options;
              options.max_evaluations = most;
              options.threads = threads;
              int asked = 0;
              const StopCondition stop(
                  [&] { return ++asked > stops ? StopRequest::kCancelled : StopRequest::kNone; });
              Evaluator e(throws ? throwing : rough, options, stop);
              Run r;
              r.done = e.evaluate_batch(X, r.cost, r.violations, what);
              r.incumbent = e.incumbent();
              r.incumbent_cost = e.incumbent_cost();
              r.evaluations = e.counters().cost_evaluations;
              r.stopped = e.stopped();
              runs.push_back(r);
            }
            for (const Run& r : runs) {
              EXPECT_EQ(r.done, runs[0].done);
              EXPECT_TRUE((r.cost == runs[0].cost).all());
              EXPECT_TRUE((r.violations == runs[0].violations).all());
              EXPECT_EQ(r.incumbent, runs[0].incumbent);
              EXPECT_EQ(r.incumbent_cost, runs[0].incumbent_cost);
              EXPECT_EQ(r.evaluations, runs[0].evaluations);
              EXPECT_EQ(r.stopped, runs[0].stopped);
            }
            EXPECT_GT(runs[0].done, 0);
            if (spread == 0.0 && throws && most > 1000 && stops > 1000) {
              EXPECT_EQ(runs[0].done, 144) << "the chunk that throws";
            }
          }
        }
      }
    }
  }
}

TEST(Evaluator, AsksBeforeEveryExactValueOfAScore) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  ProblemDefinition d = c.problem().definition();
  d.terms.front().term = std::make_shared<RoughCost>(d.terms.front().term, watch);
  const Problem rough(d);
  int asked = 0;
  const StopCondition stop(
      [&] { return ++asked > 4 ? StopRequest::kDeadline : StopRequest::kNone; });
  Evaluator e(rough, {}, stop);
  Matrix X(4, Evaluator::kChunk);  // each better than the one before
  for (int b = 0; b < X.cols(); ++b) X.col(b).setConstant(0.05 * b);
  Eigen::ArrayXd cost, violations;
  EXPECT_EQ(e.evaluate_batch(X, cost, violations, Evaluate::kScore), 3);
  EXPECT_EQ(watch->evaluations, 3);
  EXPECT_EQ(e.incumbent(), X.col(2));
  EXPECT_TRUE(e.stopped());
}

TEST(Evaluator, StandsInForARejectedPointWithABowlAroundTheIncumbent) {
  Case c = zoo::rosenbrock();
  const auto f = c.f;
  c.f = [f](const Vector& x) {
    return x[0] > 1.0 ? std::numeric_limits<double>::infinity() : f(x);
  };
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  EXPECT_EQ(e.evaluate(vec({1.5, 0}), Evaluate::kGradient), EvaluationOutcome::kRejected);
  EXPECT_TRUE(std::isfinite(e.cost()));
  EXPECT_FALSE(e.has_incumbent());
  e.evaluate(vec({-1.2, 1}), Evaluate::kGradient);
  e.evaluate(vec({-2, -2}), Evaluate::kValue);
  const double worst = f(vec({-2, -2}));
  EXPECT_EQ(e.evaluate(vec({1.5, 0.5}), Evaluate::kGradient), EvaluationOutcome::kRejected);
  EXPECT_GT(e.cost(), worst);
  EXPECT_EQ(e.incumbent(), vec({-1.2, 1}));
  for (const Vector& x : {vec({1.5, 0.5}), vec({1.9, -2}), vec({1.01, 2})}) {
    Vector g(2);
    e.rejected_cost(x, &g);
    for (int i = 0; i < 2; ++i) {
      const double h = 1e-5;
      Vector a = x, b = x;
      a[i] += h;
      b[i] -= h;
      const double difference =
          (e.rejected_cost(a, nullptr) - e.rejected_cost(b, nullptr)) / (2 * h);
      EXPECT_NEAR(g[i], difference, 1e-5 * (1 + std::abs(difference)));
    }
    EXPECT_LT(g.dot(e.incumbent() - x), 0.0);
  }
}

TEST(Evaluator, ClampsPointsAndSurvivesNanInThem) {
  const Case c = zoo::hs76();
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  const double inf = std::numeric_limits<double>::infinity();
  e.evaluate(vec({-1, 20, inf, std::numeric_limits<double>::quiet_NaN()}), Evaluate::kGradient);
  EXPECT_EQ(e.cost(), c.f(vec({0, 10, 5, 5})));
}

TEST(Evaluator, FindsAnEvaluableStart) {
  Case c = zoo::rosenbrock();
  const auto f = c.f;
  c.f = [f](const Vector& x) { return x[0] < 0.5 ? std::nan("") : f(x); };
  const Problem problem = c.problem();
  const StopCondition never;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CommonOptions options;
    options.seed = seed;
    Evaluator e(problem, options, never);
    WarmStart w;
    w.x = vec({-1.2, 1});
    Vector x;
    EXPECT_EQ(e.evaluate_start(w, Evaluate::kGradient, x), EvaluationOutcome::kEvaluated);
    EXPECT_GE(x[0], 0.5);
    EXPECT_EQ(e.cost(), f(x));
  }
}

TEST(Evaluator, KeepsTheOlderPointOfATie) {
  Case c = zoo::hs76();
  c.f = [](const Vector&) { return 1.0; };
  const Problem problem = c.problem();
  const StopCondition never;
  Evaluator e(problem, {}, never);
  e.evaluate(vec({0.5, 0.5, 0.5, 0.5}), Evaluate::kValue);
  e.evaluate(vec({0.6, 0.5, 0.5, 0.5}), Evaluate::kValue);
  EXPECT_EQ(e.incumbent(), vec({0.5, 0.5, 0.5, 0.5}));
}

TEST(Evaluator, SharesWhatAnInnerOneEvaluates) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  const StopCondition never;
  Evaluator outer(problem, {.max_evaluations = 6}, never);
  const Vector good = vec({0, 0.5, 1, -0.5}), poor = Vector::Zero(4);
  outer.evaluate(good, Evaluate::kValue);
  {
    Evaluator inner(outer, {.max_evaluations = 2});
    inner.evaluate(poor, Evaluate::kGradient);
    EXPECT_EQ(inner.incumbent(), poor);  // its own
    EXPECT_EQ(outer.incumbent(), good);
    EXPECT_EQ(inner.evaluate(vec({0.1, 0, 0, 0}), Evaluate::kValue), EvaluationOutcome::kEvaluated);
    EXPECT_EQ(inner.evaluate(vec({0.2, 0, 0, 0}), Evaluate::kValue), EvaluationOutcome::kStopped);
    const Result r = inner.finish(StopReason::kConverged, true, "", {});
    EXPECT_EQ(r.stop, StopReason::kIterationLimit);
    EXPECT_TRUE(r.explanation.terms.empty());
  }
  EXPECT_FALSE(outer.should_stop());
  EXPECT_EQ(outer.counters().cost_evaluations, 3);
  EXPECT_EQ(outer.counters().gradient_evaluations, 1);
  EXPECT_EQ(watch->evaluations, 3);
  const Vector better = vec({0, 1, 1.5, -0.5});
  ASSERT_LT(c.f(better), c.f(good));
  ASSERT_EQ(c.violation(better), 0.0);
  {
    Evaluator inner(outer, {.max_evaluations = 100});
    EXPECT_EQ(inner.evaluations_left(), 3);
    Eigen::ArrayXd cost, violations;
    EXPECT_EQ(inner.evaluate_batch(better.replicate(1, 8), cost, violations), 3);
    EXPECT_EQ(outer.incumbent(), better);
    EXPECT_TRUE(inner.stopped());
  }
  EXPECT_EQ(outer.finish(StopReason::kConverged, true, "", {}).stop, StopReason::kIterationLimit);
}

// Walks of several lengths from several starts, some of them into where a term throws: beside each
// other they come to what they come to one after another.
TEST(Evaluator, RunsBesideEachOtherWhatCouldRunInTurn) {
  const Case c = zoo::hs43();
  ProblemDefinition d = c.problem().definition();
  const Problem calm(d);
  d.terms.front().term = std::make_shared<ThrowingAbove>(d.terms.front().term);
  const Problem throwing(d);
  std::mt19937_64 generator(13);
  std::uniform_real_distribution<double> uniform(-1.0, 0.9);
  constexpr int kWalks = 9;
  const Matrix starts = Matrix::NullaryExpr(
      4, kWalks, [&](Eigen::Index, Eigen::Index) { return uniform(generator); });
  const auto walk = [&](int k, Evaluator& e) {
    for (int i = 0; i < 5 + 7 * k % 11; ++i) {
      Vector x = 0.98 * starts.col(k) + 0.02 * i * vec({0, 1, 2, -1});
      // Only the walks 4 and 6 come to where the term throws.
      x[0] = (k == 4 || k == 6) && i == 3 ? 0.99 : std::min(x[0], 0.9);
      if (e.evaluate(x, Evaluate::kGradient) == EvaluationOutcome::kStopped) return;
    }
  };
  for (const bool throws : {false, true}) {
    const Problem& problem = throws ? throwing : calm;
    const StopCondition never;
    CommonOptions options;
    options.trace = true;
    const CommonOptions inner_options = {.max_evaluations = 12};
    Evaluator in_turn(problem, options, never);
    in_turn.evaluate(Vector::Constant(4, -0.9), Evaluate::kValue);
    for (int k = 0; k < kWalks && !in_turn.stopped(); ++k) {
      Evaluator inner(in_turn, inner_options);
      walk(k, inner);
    }
    EXPECT_EQ(in_turn.stopped(), throws);
    const Counters counters = in_turn.counters();
    EXPECT_EQ(counters.gradient_evaluations + 1, counters.cost_evaluations);
    const Result expected = in_turn.finish(StopReason::kConverged, true, "", {});
    EXPECT_GT(expected.trace.size(), 3u);
    for (const int threads : {1, 2, 3, 7}) {
      options.threads = threads;
      Evaluator e(problem, options, never);
      e.evaluate(Vector::Constant(4, -0.9), Evaluate::kValue);
      for (int once : {0, 1}) {  // in two goes: what is lent out comes back
        e.run_beside(once == 0 ? 3 : kWalks - 3, inner_options,
                     [&](int k, Evaluator& inner) { walk(once == 0 ? k : k + 3, inner); });
        if (e.stopped()) break;
      }
      const Result r = e.finish(StopReason::kConverged, true, "", {});
      EXPECT_EQ(r.stop, expected.stop);
      EXPECT_EQ(r.detail, expected.detail);
      EXPECT_EQ(r.x, expected.x);
      EXPECT_EQ(r.cost, expected.cost);
      EXPECT_EQ(r.violation, expected.violation);
      EXPECT_EQ(r.counters.cost_evaluations, expected.counters.cost_evaluations);
      EXPECT_EQ(r.counters.gradient_evaluations, expected.counters.gradient_evaluations);
      ASSERT_EQ(r.trace.size(), expected.trace.size());
      for (std::size_t i = 0; i < r.trace.size(); ++i) {
        EXPECT_EQ(r.trace[i].cost, expected.trace[i].cost);
        EXPECT_EQ(r.trace[i].evaluations, expected.trace[i].evaluations);
        EXPECT_GE(r.trace[i].seconds, i == 0 ? 0.0 : r.trace[i - 1].seconds);
      }
    }
  }
}

TEST(Evaluator, AStopReachesAllThatRunBesideEachOther) {
  const Case c = zoo::hs43();
  const Problem problem = c.problem();
  for (const int threads : {1, 3}) {
    CommonOptions options;
    options.threads = threads;
    std::atomic<int> asking = 0, asked = 0;
    bool together = false;
    // It changes its mind afterwards, which changes nothing.
    const StopCondition stop([&] {
      together = together || ++asking > 1;
      const int n = ++asked;
      --asking;
      return n == 40 ? StopRequest::kCancelled : StopRequest::kNone;
    });
    Evaluator e(problem, options, stop);
    std::atomic<int> ended = 0;
    e.run_beside(5, {}, [&](int k, Evaluator& inner) {
      for (int i = 0; i < 1000; ++i) {
        const Vector x = Vector::Constant(4, 1e-3 * i - 0.1 * k);
        if (inner.evaluate(x, Evaluate::kValue) == EvaluationOutcome::kStopped) {
          ++ended;
          return;
        }
      }
    });
    EXPECT_EQ(ended, 5);
    EXPECT_FALSE(together);
    EXPECT_EQ(e.counters().cost_evaluations, 39);
    EXPECT_TRUE(e.stopped());
    EXPECT_EQ(e.finish(StopReason::kConverged, true, "", {}).stop, StopReason::kCancelled);
  }
}

TEST(Evaluator, StopsWithAnInnerOneOnlyIfTheProblemThrew) {
  const Case c = zoo::hs43();
  const auto watch = std::make_shared<Watch>();
  const Problem problem = zoo::watched(c.problem(), watch);
  const StopCondition never;
  Evaluator outer(problem, {}, never);
  Evaluator failed(outer, {});
  failed.fail("gave up");
  EXPECT_TRUE(failed.should_stop());
  EXPECT_FALSE(outer.should_stop());
  watch->throw_at = 1;
  Evaluator inner(outer, {});
  EXPECT_EQ(inner.evaluate(Vector::Zero(4), Evaluate::kValue), EvaluationOutcome::kStopped);
  EXPECT_TRUE(outer.should_stop());
  const Result r = outer.finish(StopReason::kConverged, true, "", {});
  EXPECT_EQ(r.stop, StopReason::kError);
  EXPECT_THAT(r.detail, testing::HasSubstr("injected fault"));
}

}  // namespace
}  // namespace prospect::evaluator_test
