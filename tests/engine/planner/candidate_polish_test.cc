// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/candidate_polish.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "models/unicycle.h"

namespace prospect::candidate_polish_test {
namespace {

/// (x - 1)^2 of where the robot ends [m^2].
class EndAtOne final : public Term {
 public:
  std::string_view name() const override { return "end_at_one"; }
  TermTraits traits() const override { return {}; }
  void evaluate(const TrajectoryBatch& t, const TermRequest&, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      out.value(0, b) = std::pow(t.px(t.horizon.N, b) - 1.0, 2);
    }
  }
};

class Solve final : public Solver {
 public:
  using Function = std::function<Result(const Problem&, const WarmStart&, const Options&)>;
  Solve(bool compares, Function f) : compares_(compares), f_(std::move(f)) {}
  std::string name() const override { return "test"; }
  std::vector<OptionInfo> options() const override { return {{"threads", 1, ""}}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  bool compares_starts() const override { return compares_; }
  Result solve(const Problem& p, const WarmStart& w, const Options& o,
               const StopCondition&) const override {
    return f_(p, w, o);
  }

 private:
  bool compares_;
  Function f_;
};

class CandidatePolish : public ::testing::Test {
 protected:
  CandidatePolish() {
    ProblemDefinition d;
    d.model = std::make_shared<Unicycle>();
    d.x0 = Eigen::Vector3d::Zero();
    d.u_previous = Eigen::Vector2d::Zero();
    d.N = 4;
    d.M = 2;
    d.terms = {{std::make_shared<EndAtOne>(), 1.0}};
    problem_ = std::make_unique<Problem>(std::move(d));
    // Two that end within a few millimetres, and one turned away.
    for (const auto& [name, v, w] :
         {std::tuple{"near", 0.3, 0.0}, {"beside", 0.299, 0.0}, {"turned", 0.3, 0.9}}) {
      candidates_.push_back({name, Eigen::Vector4d(v, w, v, w)});
    }
    candidates_ = evaluate(candidates_, Evaluate::kScore, evaluation());
  }
  CandidateEvaluation evaluation() { return {*problem_, nullptr, 1, workers_}; }
  Result result(const Eigen::VectorXd& x) {
    Result r;
    r.stop = StopReason::kConverged;
    r.quality = Quality::kFeasible;
    r.x = x;
    r.cost = -1e9;  // it says; nobody believes it
    r.counters.cost_evaluations = 5;
    return r;
  }

  std::unique_ptr<Problem> problem_;
  WorkerThreads workers_{1};
  std::vector<Candidate> candidates_;
};

TEST_F(CandidatePolish, OneOfEachBasinAndMeasuredAgain) {
  int calls = 0;
  const Solve solver(false, [&](const Problem& p, const WarmStart& w, const Options& o) {
    ++calls;
    EXPECT_EQ(std::get<int>(o.at("max_evaluations")), 7);
    EXPECT_EQ(o.count("threads"), 0U);
    Eigen::VectorXd x = w.x;
    x[0] = x[2] = p.upper()[0];
    return result(x);
  });
  const PolishOutcome outcome = polish(candidates_, solver, {2, 7, {}}, evaluation(), {});
  EXPECT_EQ(calls, 2) << "'near' and 'turned', not 'beside'";
  EXPECT_EQ(outcome.counters.cost_evaluations, 10);
  ASSERT_EQ(candidates_.size(), 5U);
  int polished = 0;
  for (const Candidate& c : candidates_) {
    polished += c.result.has_value();
    EXPECT_GE(c.cost, 0.0) << "the problem's own cost, not what the solver said";
  }
  EXPECT_EQ(polished, 2);
}

TEST_F(CandidatePolish, ASolverThatComparesStartsGetsThemAll) {
  int calls = 0;
  const Solve solver(true, [&](const Problem&, const WarmStart& w, const Options& o) {
    ++calls;
    EXPECT_EQ(w.seeds.cols(), 2);
    EXPECT_EQ(std::get<int>(o.at("max_evaluations")), 2 * 7 + 3);
    EXPECT_EQ(std::get<int>(o.at("threads")), 1);
    return result(w.x);
  });
  EXPECT_TRUE(shares_threads(solver));
  polish(candidates_, solver, {2, 7, {}, true}, evaluation(), {});
  EXPECT_EQ(calls, 1);
}

TEST_F(CandidatePolish, WhatASolverBreaksAddsNothing) {
  for (const int kind : {0, 1, 2}) {
    std::vector<Candidate> candidates = candidates_;
    const Solve solver(false, [&](const Problem&, const WarmStart& w, const Options&) -> Result {
      if (kind == 0) throw std::runtime_error("out of ideas");
      Eigen::VectorXd x = w.x;
      if (kind == 1) x[0] = std::nan("");
      return result(kind == 2 ? Eigen::VectorXd(x.head(2)) : x);
    });
    const PolishOutcome outcome = polish(candidates, solver, {2, 7, {}}, evaluation(), {});
    EXPECT_EQ(candidates.size(), candidates_.size()) << kind;
    if (kind == 0) {
      EXPECT_EQ(outcome.error, "the solver threw: out of ideas");
    }
  }
}

TEST_F(CandidatePolish, NothingIsAskedForAfterTheStop) {
  int calls = 0;
  const Solve solver(false, [&](const Problem&, const WarmStart& w, const Options&) {
    ++calls;
    return result(w.x);
  });
  polish(candidates_, solver, {2, 7, {}}, evaluation(),
         StopCondition([] { return StopRequest::kDeadline; }));
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(candidates_.front().error, 0.0);
}

}  // namespace
}  // namespace prospect::candidate_polish_test
