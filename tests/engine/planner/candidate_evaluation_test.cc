// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/candidate_evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "models/unicycle.h"

namespace prospect::candidate_evaluation_test {
namespace {

/// The distance driven along x [m]; nan for one that ends behind x = -0.5.
class Advance final : public Term {
 public:
  explicit Advance(bool scores_overflow) : scores_overflow_(scores_overflow) {}
  std::string_view name() const override { return "advance"; }
  TermTraits traits() const override {
    TermTraits traits;
    traits.scores = true;
    return traits;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      const double x = t.px(t.horizon.N, b);
      const bool bad = x < -0.5 || (request.score && scores_overflow_);
      out.value(0, b) = bad ? std::nan("") : x;
    }
  }

 private:
  bool scores_overflow_;
};

struct Scene {
  std::shared_ptr<const Advance> term;
  std::unique_ptr<Problem> problem;
  explicit Scene(bool scores_overflow = false) : term(std::make_shared<Advance>(scores_overflow)) {
    ProblemDefinition d;
    d.model = std::make_shared<Unicycle>();
    d.x0 = Eigen::Vector3d::Zero();
    d.u_previous = Eigen::Vector2d::Zero();
    d.N = 4;
    d.M = 2;
    d.terms = {{term, 2.0}};
    problem = std::make_unique<Problem>(std::move(d));
  }
  std::vector<Candidate> driving(const std::vector<double>& speeds) const {
    std::vector<Candidate> all;
    for (const double v : speeds) {
      all.push_back({std::to_string(v), Eigen::Vector4d(v, 0.0, v, 0.0)});
    }
    return all;
  }
};

TEST(CandidateEvaluation, BestFirstWithoutThoseThatCannotBeEvaluated) {
  const Scene scene;
  WorkerThreads workers(1);
  const auto out = evaluate(scene.driving({0.3, -0.2, -5.0, 0.1}), Evaluate::kValue,
                            {*scene.problem, scene.term.get(), 1, workers});
  ASSERT_EQ(out.size(), 3U);
  EXPECT_EQ(out.front().name, std::to_string(-0.2));
  EXPECT_EQ(out.back().name, std::to_string(0.3));
  for (const Candidate& c : out) {
    EXPECT_DOUBLE_EQ(c.cost, 2.0 * c.features) << "the term's own value, not weighted";
    EXPECT_EQ(c.error, 0.0);
  }
}

TEST(CandidateEvaluation, ScoresThatOverflowAreMeasuredExactly) {
  const Scene scene(true);
  WorkerThreads workers(1);
  const auto out =
      evaluate(scene.driving({0.3, 0.1}), Evaluate::kScore, {*scene.problem, nullptr, 1, workers});
  ASSERT_EQ(out.size(), 2U);
  EXPECT_NEAR(out.front().cost, 0.2, 1e-12);
  EXPECT_EQ(out.front().features, 0.0) << "no such term";
}

TEST(CandidateEvaluation, TheSameBitsWithAnyNumberOfThreads) {
  const Scene scene;
  std::vector<double> speeds;
  for (int k = 0; k < 37; ++k) speeds.push_back(0.01 * ((k * 17) % 37));
  WorkerThreads one(1), three(3);
  const auto a =
      evaluate(scene.driving(speeds), Evaluate::kScore, {*scene.problem, scene.term.get(), 1, one});
  const auto b = evaluate(scene.driving(speeds), Evaluate::kScore,
                          {*scene.problem, scene.term.get(), 3, three});
  ASSERT_EQ(a.size(), speeds.size());
  ASSERT_EQ(b.size(), speeds.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].cost, b[i].cost);
  }
}

TEST(CandidateEvaluation, OnceTheTimeIsUpTheFirstTwoAreLeft) {
  const Scene scene;
  const std::vector<double> speeds(20, 0.1);
  for (const int threads : {1, 3}) {
    WorkerThreads workers(threads);
    const CandidateEvaluation with{*scene.problem, scene.term.get(), threads, workers};
    EXPECT_EQ(evaluate(scene.driving(speeds), Evaluate::kScore, with, deadline(0.0)).size(), 2U);
    EXPECT_EQ(evaluate(scene.driving(speeds), Evaluate::kScore, with, deadline(100.0)).size(), 20U);
  }
}

TEST(CandidateEvaluation, NoneIsNone) {
  const Scene scene;
  WorkerThreads workers(1);
  EXPECT_TRUE(
      evaluate({}, Evaluate::kValue, {*scene.problem, scene.term.get(), 1, workers}).empty());
}

}  // namespace
}  // namespace prospect::candidate_evaluation_test
