// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "adapters/missions/bench/bench_files.h"
#include "adapters/missions/bench/bench_page.h"
#include "adapters/missions/bench/bench_summary.h"
#include "problems/zoo.h"
#include "solvers/options.h"

namespace prospect::bench_run_test {
namespace {

using ::testing::HasSubstr;

/// A back end whose results are written down: walks through points of decreasing cost.
class Scripted final : public Solver {
 public:
  Scripted(std::string name, std::vector<Improvement> trace)
      : name_(std::move(name)), trace_(std::move(trace)) {}
  std::string name() const override { return name_; }
  std::vector<OptionInfo> options() const override { return common_options(); }
  std::string explain_unsupported(const Problem& p) const override {
    return p.num_variables() > 3 ? "takes three variables at most" : "";
  }
  Result solve(const Problem&, const WarmStart&, const Options& options,
               const StopCondition&) const override {
    EXPECT_EQ(std::get<int>(options.at("trace")), 1);
    Result r;
    r.trace = trace_;
    r.stop = StopReason::kConverged;
    r.quality = Quality::kFeasible;
    r.cost = trace_.back().cost;
    r.violation = trace_.back().violation;
    r.counters = {trace_.back().evaluations + 5, 0, 1};
    return r;
  }

 private:
  std::string name_;
  std::vector<Improvement> trace_;
};

SolverChoice scripted(const std::string& name, std::vector<Improvement> trace) {
  return {name, std::make_shared<Scripted>(name, std::move(trace)), {}};
}

ProblemSet two_problems() {
  ProblemSet set;
  set.name = "two";
  for (const FunctionProblem& p : {zoo::hs35(), zoo::hs43()}) {  // 3 and 4 variables
    BenchProblem problem;
    problem.name = p.name;
    problem.problem = std::make_shared<const Problem>(p.problem());
    problem.start.x = p.start;
    set.problems.push_back(problem);
  }
  set.problems[0].best_known = 10.0;
  return set;
}

const std::vector<Improvement> kGood = {
    {0.001, 1, 50.0, 1.0}, {0.002, 4, 30.0, 0.0}, {0.003, 9, 10.09, 0.0}, {0.004, 20, 10.05, 0.0}};
const std::vector<Improvement> kPoor = {{0.001, 1, 20.0, 0.0}, {0.010, 100, 12.0, 0.0}};
const std::vector<Improvement> kInfeasible = {{0.001, 1, 5.0, 0.1}};

BenchTable table() {
  return run_bench({two_problems()},
                   {scripted("good", kGood), scripted("poor", kPoor), scripted("off", kInfeasible)},
                   {});
}

TEST(BenchRun, JudgesEveryRowAgainstTheBestKnown) {
  const BenchTable t = table();
  ASSERT_EQ(t.rows.size(), 6U);
  EXPECT_EQ(t.best[0][0].cost, 10.0);
  EXPECT_EQ(t.best[0][0].found_by, "stored");
  const BenchRow &good = t.rows[0], &poor = t.rows[1], &off = t.rows[2];
  EXPECT_TRUE(good.solved);
  EXPECT_NEAR(good.gap, 0.005, 1e-15);
  EXPECT_EQ(good.seconds_to_target, 0.003);  // 10.09 is within 1 %
  EXPECT_EQ(good.evaluations_to_target, 9);
  EXPECT_FALSE(poor.solved);
  EXPECT_NEAR(poor.gap, 0.2, 1e-15);
  EXPECT_TRUE(std::isinf(poor.seconds_to_target));
  EXPECT_FALSE(off.solved);  // cheap, but not feasible
  EXPECT_TRUE(std::isinf(off.gap));
  for (int i = 3; i < 6; ++i) {
    EXPECT_FALSE(t.rows[i].supported);
    EXPECT_THAT(t.rows[i].detail, HasSubstr("three variables"));
  }
  EXPECT_TRUE(std::isinf(t.best[0][1].cost));
}

TEST(BenchRun, TakesAFeasibleResultBelowTheStoredOneForTheBest) {
  ProblemSet set = two_problems();
  set.problems[0].best_known = 20.0;
  const BenchTable t =
      run_bench({set}, {scripted("good", kGood), scripted("off", kInfeasible)}, {});
  EXPECT_EQ(t.best[0][0].cost, 10.05);
  EXPECT_EQ(t.best[0][0].found_by, "good");
}

/// A back end that calls every start an optimum.
class Boaster final : public Solver {
 public:
  std::string name() const override { return "boaster"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem& problem, const WarmStart& start, const Options&,
               const StopCondition&) const override {
    Result r;
    r.stop = StopReason::kConverged;
    r.quality = Quality::kFeasibleOptimum;
    r.x = start.x;
    r.cost = problem.explain(start.x).cost;
    return r;
  }
};

TEST(BenchRun, VerifiesAClaimedOptimumOfEveryBackEnd) {
  ProblemSet set;
  set.name = "claims";
  const FunctionProblem cargo = zoo::cargo(), hs43 = zoo::hs43();
  set.problems.push_back(started("false", cargo.problem(), cargo.start, cargo.optimum));
  set.problems.push_back(started("true", hs43.problem(), vec({0, 1, 2, -1}), hs43.optimum));
  const BenchTable t = run_bench({set}, {{"boaster", std::make_shared<Boaster>(), {}}}, {});
  EXPECT_EQ(t.rows[0].claimed, Quality::kFeasibleOptimum);
  EXPECT_EQ(t.rows[0].quality, Quality::kFeasible);
  EXPECT_GT(t.rows[0].optimality, 0.1);
  EXPECT_EQ(t.rows[1].quality, Quality::kFeasibleOptimum);
  EXPECT_LT(t.rows[1].optimality, 1e-9);
  EXPECT_EQ(t.rows[1].x, vec({0, 1, 2, -1}));
}

TEST(BenchRun, MeasuresWhatIsSolvedByTheDifferenceToTheStart) {
  // Neither a scale nor an offset of the cost makes a start solved, nor keeps an end from it.
  for (const double scale : {1e-7, 1.0, 1e9}) {
    for (const double offset : {0.0, 1e3, -1e6}) {
      FunctionProblem p = zoo::rosenbrock();
      p.f = [=, f = p.f](const Eigen::VectorXd& x) { return offset + scale * f(x); };
      p.g = [=, g = p.g](const Eigen::VectorXd& x) { return Eigen::VectorXd(scale * g(x)); };
      ProblemSet set;
      set.absolute_tolerance = 0.0;
      set.problems.push_back(started("p", p.problem(), p.start, offset));
      set.problems.push_back(started("q", p.problem(), vec({1, 1}), offset));
      const BenchTable t = run_bench({set}, {{"boaster", std::make_shared<Boaster>(), {}}}, {});
      EXPECT_FALSE(t.rows[0].solved) << scale << ' ' << offset;
      EXPECT_EQ(t.rows[0].quality, Quality::kFeasible);
      EXPECT_TRUE(t.rows[1].solved) << scale << ' ' << offset;
    }
  }
}

/// Goes down to where the cost ends, or to the lower bounds, and calls that an optimum.
class Downhill final : public Solver {
 public:
  explicit Downhill(double end) : end_(end) {}
  std::string name() const override { return "downhill"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem& problem, const WarmStart&, const Options&,
               const StopCondition&) const override {
    Result r;
    r.stop = StopReason::kConverged;
    r.quality = Quality::kFeasibleOptimum;
    r.x = problem.lower().cwiseMax(end_);
    r.cost = problem.explain(r.x).cost;
    return r;
  }

 private:
  double end_;
};

TEST(BenchRun, MovesBoundsThatNobodyStatedAndSaysWhatIsUnbounded) {
  for (const double end : {-300.0, -1e300}) {
    const bool unbounded = end < -1e8;
    FunctionProblem p;
    p.f = [end](const Eigen::VectorXd& x) { return std::abs(x[0] - std::max(end, -1e9)); };
    p.g = [](const Eigen::VectorXd&) { return vec({1.0}); };
    p.start = vec({0.0});
    const auto within = [p](double far) {
      FunctionProblem q = p;
      q.lower = vec({-far});
      q.upper = vec({100.0});
      return std::make_shared<const Problem>(q.problem());
    };
    ProblemSet set;
    set.problems.push_back(started("p", *within(100.0), p.start, {}));
    set.problems[0].no_lower = {0};
    set.problems[0].with_bounds = within;
    const BenchTable t = run_bench({set}, {{"downhill", std::make_shared<Downhill>(end), {}}}, {});
    const BenchRow& row = t.rows[0];
    EXPECT_EQ(row.held, unbounded);
    EXPECT_EQ(row.solved, !unbounded);
    EXPECT_EQ(row.stop, unbounded ? StopReason::kUnbounded : StopReason::kConverged) << row.detail;
    EXPECT_EQ(row.x[0], unbounded ? -1e8 : -300.0);
    if (unbounded) {
      EXPECT_EQ(row.quality, Quality::kFeasible);
      // Nor has it been solved by who stops on the way and is the best of them.
      const BenchTable two = run_bench({set},
                                       {{"downhill", std::make_shared<Downhill>(end), {}},
                                        {"stops", std::make_shared<Downhill>(-50.0), {}}},
                                       {});
      for (const BenchRow& each : two.rows) EXPECT_FALSE(each.solved);
    }
  }
}

/// Has nothing to do for 20 ms, as where others have the processor.
class Waiting final : public Solver {
 public:
  std::string name() const override { return "waiting"; }
  std::vector<OptionInfo> options() const override { return common_options(); }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem&, const WarmStart&, const Options&,
               const StopCondition& stop) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    Result r;
    r.stop = stop() == StopRequest::kNone ? StopReason::kConverged : StopReason::kDeadline;
    r.quality = Quality::kFeasible;
    return r;
  }
};

TEST(BenchRun, CountsTimeByTheClockAskedForAndTellsABusyMachine) {
  BenchOptions options;
  options.deadlines = {0.015};
  for (const SolveClock clock : {SolveClock::kWall, SolveClock::kProcessor}) {
    options.clock = clock;
    const BenchTable t =
        run_bench({two_problems()}, {{"waiting", std::make_shared<Waiting>(), {}}}, options);
    const bool wall = clock == SolveClock::kWall;
    for (const BenchRow& row : t.rows) {
      EXPECT_EQ(row.stop, wall ? StopReason::kDeadline : StopReason::kConverged);
      EXPECT_GE(row.wall_seconds, 0.02);
      EXPECT_LT(row.processor_seconds, 0.015);
      EXPECT_EQ(row.seconds, wall ? row.wall_seconds : row.processor_seconds);
    }
    EXPECT_GT(waited(t), kMostWaited);
    const std::string text = bench_text(t, summarize(t).front());
    EXPECT_THAT(text, HasSubstr("busy machine: solves waited"));
    EXPECT_EQ(text.find("times of the processor") == std::string::npos, wall);
    EXPECT_THAT(bench_csv(t), HasSubstr(wall ? ",wall," : ",cpu,"));
  }
  BenchTable idle;
  idle.rows.resize(1);
  idle.rows[0].wall_seconds = 1.0;
  idle.rows[0].processor_seconds = 0.96;
  EXPECT_EQ(busy_sentence(idle), "");
}

TEST(BenchRun, SolvesOnceWithEachSeed) {
  BenchOptions options;
  options.seeds = {3, 5};
  int rows = 0;
  options.on_row = [&](const BenchTable& of, const BenchRow& row) {
    ++rows;
    EXPECT_EQ(&of.rows.back(), &row);
  };
  const BenchTable t = run_bench({two_problems()}, {scripted("good", kGood)}, options);
  EXPECT_EQ(rows, 4);
  ASSERT_EQ(t.rows.size(), 4U);
  EXPECT_EQ(t.rows[0].seed, 3);
  EXPECT_EQ(t.rows[1].seed, 5);
  EXPECT_EQ(t.rows[1].problem, 0);
  EXPECT_EQ(summarize(t)[0].problems, 4);  // each problem with each seed
}

TEST(BenchRun, SummarizesByHandComputedNumbers) {
  const auto groups = summarize(table());
  ASSERT_EQ(groups.size(), 1U);
  const SolverSummary &good = groups[0].solvers[0], &poor = groups[0].solvers[1];
  EXPECT_EQ(good.solved, 1);
  EXPECT_EQ(good.refused, 1);
  EXPECT_EQ(good.problems, 2);
  EXPECT_DOUBLE_EQ(good.ms_to_target_median, 3.0);
  EXPECT_TRUE(std::isinf(good.ms_to_target_p90));  // the other problem is not solved
  EXPECT_EQ(good.evaluations_median, 25.0);
  EXPECT_EQ(good.by_time.at(1.0), 0.5);
  EXPECT_EQ(poor.solved, 0);
  EXPECT_TRUE(poor.by_time.steps.empty());
  EXPECT_EQ(groups[0].solvers[2].feasible, 0);
}

TEST(GapCurve, FollowsTheIncumbentsOfTheRows) {
  const BenchTable t = table();
  const GapCurve curve = gap_curve(t, {&t.rows[0]}, GapAxis::kEvaluations, 1.0, 100.0, 3);
  ASSERT_EQ(curve.points.size(), 3U);  // at 1, 10 and 100 evaluations
  EXPECT_TRUE(std::isinf(curve.points[0].median));
  EXPECT_DOUBLE_EQ(curve.points[1].at, 10.0);
  EXPECT_NEAR(curve.points[1].median, 0.009, 1e-12);
  EXPECT_NEAR(curve.points[2].median, 0.005, 1e-12);
  const GapCurve both = gap_curve(t, {&t.rows[0], &t.rows[1]}, GapAxis::kSeconds, 0.02, 0.02, 1);
  EXPECT_NEAR(both.points[0].lower, 0.005, 1e-12);
  EXPECT_NEAR(both.points[0].upper, 0.2, 1e-12);
  EXPECT_TRUE(gap_curve(t, {}, GapAxis::kSeconds, 1e-3, 1.0, 5).points.empty());
}

/// A back end that finds a worse cost with every solve.
class Tiring final : public Solver {
 public:
  std::string name() const override { return "tiring"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem&, const WarmStart&, const Options&,
               const StopCondition&) const override {
    Result r;
    r.stop = StopReason::kDeadline;
    r.quality = Quality::kFeasible;
    r.cost = ++*solves_;
    r.violation = 0.0;
    r.trace = {{1e-3, 1, r.cost, 0.0}};
    if (*solves_ == 1) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return r;
  }

 private:
  std::shared_ptr<int> solves_ = std::make_shared<int>(0);
};

TEST(BenchRun, TakesTheMedianOfTheRepeatsUnderADeadlineAndTheirWorstOverrun) {
  ProblemSet set = two_problems();
  set.problems.resize(1);
  set.problems[0].best_known.reset();
  BenchOptions options;
  options.repeats = 3;
  options.deadlines = {0.01};
  const BenchTable t = run_bench({set}, {{"tiring", std::make_shared<Tiring>(), {}}}, options);
  ASSERT_EQ(t.rows.size(), 1U);
  EXPECT_EQ(t.rows[0].cost, 2.0);
  EXPECT_GE(t.rows[0].overrun, 0.02);
  options.deadlines = {0.0};
  const BenchTable fastest =
      run_bench({set}, {{"tiring", std::make_shared<Tiring>(), {}}}, options);
  EXPECT_GT(fastest.rows[0].cost, 1.0);  // the first one sleeps
  EXPECT_EQ(fastest.rows[0].overrun, 0.0);
}

/// A back end that knows nothing of traces and refuses every option.
class Plain final : public Solver {
 public:
  std::string name() const override { return "plain"; }
  std::vector<OptionInfo> options() const override { return {}; }
  std::string explain_unsupported(const Problem&) const override { return ""; }
  Result solve(const Problem&, const WarmStart&, const Options& options,
               const StopCondition&) const override {
    EXPECT_TRUE(options.empty());
    Result r;
    r.stop = StopReason::kConverged;
    r.quality = Quality::kFeasible;
    r.cost = 10.01;
    r.counters.cost_evaluations = 7;
    return r;
  }
};

TEST(BenchRun, TakesTheEndOfASolveThatKeepsNoTrace) {
  ProblemSet set = two_problems();
  set.problems.resize(1);
  const BenchTable t = run_bench({set}, {{"plain", std::make_shared<Plain>(), {}}}, {});
  EXPECT_TRUE(t.rows[0].solved);
  EXPECT_EQ(t.rows[0].seconds_to_target, t.rows[0].seconds);
  EXPECT_EQ(t.rows[0].evaluations_to_target, 7);
  EXPECT_EQ(summarize(t)[0].solvers[0].by_time.at(1.0), 1.0);
}

TEST(BenchRun, KeepsTheProblemsThatAllWereDoneWithWhenItIsCancelled) {
  // Cancelled in solve 1, 3, ...: of two back ends on two sets of two problems.
  for (const int last : {1, 3, 5, 7}) {
    int done = 0;
    BenchOptions options;
    options.on_solve = [&](int k, int) { done = k; };
    options.cancelled = [&] { return done >= last; };
    const SolverChoice plain{"plain", std::make_shared<Plain>(), {}};
    const BenchTable t = run_bench({two_problems(), two_problems()}, {plain, plain}, options);
    EXPECT_TRUE(t.cancelled);
    const int whole = last / 2;
    int problems = 0;
    for (const ProblemSetFacts& set : t.sets) {
      EXPECT_FALSE(set.problems.empty());
      problems += static_cast<int>(set.problems.size());
    }
    EXPECT_EQ(problems, whole);
    ASSERT_EQ(static_cast<int>(t.rows.size()), 2 * whole);
    EXPECT_EQ(t.best.size(), t.sets.size());
    const auto groups = summarize(t);
    if (whole > 0) {
      EXPECT_EQ(groups.front().problems, whole);
    }
    EXPECT_TRUE(bench_json(t, groups, true).at("cancelled").get<bool>());
  }
}

TEST(BenchFiles, HaveARowForEveryCellAndAsManyFieldsAsTheHead) {
  const BenchTable t = table();
  std::istringstream csv(bench_csv(t));
  std::string head, line;
  std::getline(csv, head);
  const auto commas = std::count(head.begin(), head.end(), ',');
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
  EXPECT_EQ(rows, 6);
  EXPECT_THAT(bench_csv(t), HasSubstr("\ntwo,HS35,3,1,good,,10.05,0,10,"));
  EXPECT_THAT(bench_csv(t), HasSubstr("\ntwo,HS43,4,3,good,,,,,,0,"));
}

TEST(BenchFiles, HaveJsonThatReadsBackWithWhatTheTableSays) {
  BenchTable t = table();
  t.environments = {{{"processor", "abacus"}}};
  const auto groups = summarize(t);
  const auto json = nlohmann::ordered_json::parse(bench_json(t, groups, true).dump());
  EXPECT_EQ(json["environments"][0]["processor"], "abacus");
  EXPECT_EQ(json["cancelled"], false);
  EXPECT_EQ(json["rows"].size(), 6U);
  EXPECT_EQ(json["rows"][0]["cost"], 10.05);
  EXPECT_EQ(json["rows"][0]["trace"]["cost"].size(), 4U);
  EXPECT_TRUE(json["rows"][1]["ms_to_target"].is_null());
  EXPECT_TRUE(json["rows"][3]["cost"].is_null());
  EXPECT_EQ(json["rows"][3]["stop_reason"], "not supported");
  EXPECT_EQ(json["summary"][0]["solvers"][0]["solved"], 1);
  EXPECT_EQ(json["sets"][0]["problems"][0]["best_known"], 10.0);
  EXPECT_THAT(bench_text(t, groups[0]), HasSubstr("good         1/2"));
}

TEST(BenchPage, HoldsTheDataAndLeavesNoPlaceUnfilled) {
  BenchTable t = table();
  t.sets[0].name = "</script><b>";
  const std::string page = bench_page(bench_json(t, summarize(t), false));
  for (const char* place : {"{{title}}", "{{style}}", "{{bench}}", "{{library", "{{script}}"}) {
    EXPECT_EQ(page.find(place), std::string::npos) << place;
  }
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_THAT(page, HasSubstr("profile_by_time"));
  EXPECT_THAT(page, HasSubstr("Dygraph"));
}

}  // namespace
}  // namespace prospect::bench_run_test
