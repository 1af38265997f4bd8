// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/expression_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "solvers/registry.h"

namespace prospect::expression_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ExpressionFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text) const {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string refusal(const std::string& text) const {
    try {
      read_expression_file(write(text));
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1U);
      EXPECT_THAT(e.what(), HasSubstr(path_ + ": "));
      return e.what();
    }
    return "accepted";
  }
  /// HS14 with one entry replaced.
  static std::string hs14(const std::string& entry = "", const std::string& with = "") {
    std::string text = R"({"problems": [{"name": "HS14", "n": 2, "x0": [2, 2],
      "objective": "(x1-2)^2+(x2-1)^2", "equalities_zero": ["x1-2*x2+1"],
      "inequalities_nonneg": ["-0.25*x1^2-x2^2+1"], "lower": [null, -3], "upper": [null, null],
      "f_opt": 1.3934646209, "note": "anything"}]})";
    if (!entry.empty()) text.replace(text.find(entry), entry.size(), with);
    return text;
  }
  const std::string path_ = (fs::path(::testing::TempDir()) / "expressions.json").string();
};

void expect_derivatives(const Problem& problem, const Eigen::VectorXd& x) {
  Workspace workspace = problem.make_workspace();
  Evaluation e, ahead, behind;
  ASSERT_TRUE(problem.evaluate(x, Evaluate::kGradient, workspace, e));
  for (int i = 0; i < x.size(); ++i) {
    const double h = 1e-6 * std::max(1.0, std::abs(x[i]));
    Eigen::VectorXd moved = x;
    moved[i] = x[i] + h;
    problem.evaluate(moved, Evaluate::kValue, workspace, ahead);
    moved[i] = x[i] - h;
    problem.evaluate(moved, Evaluate::kValue, workspace, behind);
    const double slope = (ahead.cost[0] - behind.cost[0]) / (2.0 * h);
    EXPECT_NEAR(e.gradient[i], slope, 1e-5 * std::max(1.0, e.gradient.norm()));
    for (int r = 0; r < problem.num_constraints(); ++r) {
      const double row = (ahead.constraints(r, 0) - behind.constraints(r, 0)) / (2.0 * h);
      EXPECT_NEAR(e.jacobian(r, i), row, 1e-5 * std::max(1.0, e.jacobian.row(r).norm()));
    }
  }
}

TEST_F(ExpressionFile, StatesBoundsAndEqualitiesAsAProblemCan) {
  const ProblemSet set = read_expression_file(write(hs14()));
  EXPECT_EQ(set.name, "expressions");
  ASSERT_EQ(set.problems.size(), 1U);
  const BenchProblem& p = set.problems[0];
  EXPECT_EQ(p.best_known, 1.3934646209);
  EXPECT_EQ(p.problem->lower(), Eigen::Vector2d(-102.0, -3.0));
  EXPECT_EQ(p.problem->upper(), Eigen::Vector2d(102.0, 102.0));
  ASSERT_EQ(p.problem->num_constraints(), 3);
  Workspace workspace = p.problem->make_workspace();
  Evaluation e;
  p.problem->evaluate(Eigen::Vector2d(0.5, 0.25), Evaluate::kValue, workspace, e);
  EXPECT_DOUBLE_EQ(e.cost[0], 1.5 * 1.5 + 0.75 * 0.75);
  EXPECT_DOUBLE_EQ(e.constraints(0, 0), 1.0 - 0.0625 - 0.0625);
  EXPECT_DOUBLE_EQ(e.constraints(1, 0), 1.0 + 1e-6);
  EXPECT_DOUBLE_EQ(e.constraints(2, 0), -1.0 + 1e-6);
  expect_derivatives(*p.problem, Eigen::Vector2d(0.3, -1.2));
}

TEST_F(ExpressionFile, SaysWhichBoundsNobodyStated) {
  const ProblemSet set = read_expression_file(write(hs14("[null, -3]", "[200, -3]")));
  const BenchProblem& p = set.problems[0];
  EXPECT_EQ(p.no_lower, std::vector<int>{});
  EXPECT_EQ(p.no_upper, (std::vector{0, 1}));
  EXPECT_EQ(p.problem->lower(), Eigen::Vector2d(200.0, -3.0));
  EXPECT_EQ(p.problem->upper(), Eigen::Vector2d(300.0, 102.0));  // beyond what is stated
  EXPECT_EQ(p.with_bounds(1e4)->upper(), Eigen::Vector2d(10200.0, 10002.0));
}

TEST_F(ExpressionFile, TakesAnEqualityInAnyUnit) {
  for (const char* equality : {"(x1-2*x2+1)/10000000", "10000000*(x1-2*x2+1)"}) {
    const ProblemSet set = read_expression_file(write(hs14("x1-2*x2+1", equality)));
    Workspace workspace = set.problems[0].problem->make_workspace();
    Evaluation e;
    // Off by 1e-3, far more than the tolerance, and not by a million.
    set.problems[0].problem->evaluate(Eigen::Vector2d(1.001, 1.0), Evaluate::kValue, workspace, e);
    EXPECT_LT(e.constraints(2, 0), -1e-5) << equality;
    EXPECT_GT(e.constraints(2, 0), -1.0) << equality;
  }
}

TEST_F(ExpressionFile, MayLackItsOptimum) {
  for (const char* unknown : {"\"f_opt\": null", "\"note 2\": 1"}) {
    const ProblemSet set = read_expression_file(write(hs14("\"f_opt\": 1.3934646209", unknown)));
    EXPECT_FALSE(set.problems[0].best_known.has_value());
    EXPECT_EQ(set.best_known_source, "");
  }
}

TEST_F(ExpressionFile, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(refusal(""), HasSubstr("is no JSON; expected"));
  EXPECT_THAT(refusal("{}"), HasSubstr("has no problems; expected"));
  EXPECT_THAT(refusal("[]"), HasSubstr("has no problems; expected"));
  EXPECT_THAT(refusal("{\"problems\": [3]}"), HasSubstr("problem 1: is no object; expected"));
  EXPECT_THAT(refusal(hs14("\"n\": 2", "\"n\": 2.5")), HasSubstr("'HS14': n is no such number"));
  EXPECT_THAT(refusal(hs14("\"n\": 2", "\"n\": 1e300")), HasSubstr("n is no such number"));
  EXPECT_THAT(refusal(hs14("[2, 2]", "[2]")), HasSubstr("x0 is not of that length; expected 2"));
  EXPECT_THAT(refusal(hs14("[2, 2]", "[2, null]")), HasSubstr("x0[1] is no number; expected"));
  EXPECT_THAT(refusal(hs14("[null, -3]", "[null, \"a\"]")), HasSubstr("lower[1] is no number"));
  EXPECT_THAT(refusal(hs14("[null, null]", "[null, -5]")), HasSubstr("lower[1] is above upper"));
  EXPECT_THAT(refusal(hs14("x2+1", "x3+1")), HasSubstr("equalities_zero 'x1-2*x3+1', at 6: "));
  EXPECT_THAT(refusal(hs14("\"f_opt\": 1.3934646209", "\"f_opt\": \"low\"")),
              HasSubstr("f_opt is no number; expected"));
  EXPECT_THAT(refusal(hs14("\"(x1-2)^2+(x2-1)^2\"", "7")), HasSubstr("objective is no text"));
  EXPECT_THAT(refusal(hs14("\"n\": 2", "\"n\": 2, \"inequalities_nonpos\": [\"x1\"]")),
              HasSubstr("'HS14': inequalities_nonpos is not read; expected"));
  const std::string one = hs14(),
                    twice = one.substr(0, one.size() - 2) + "," + one.substr(one.find("[{") + 1);
  EXPECT_THAT(refusal(twice), HasSubstr("'HS14' is there twice; expected"));
  EXPECT_THROW(read_expression_file(path_ + ".nothing"), InputError);
}

TEST_F(ExpressionFile, StatesTheHockSchittkowskiProblems) {
  const std::string path = std::string(PROSPECT_SHARED_DATA) + "/nlp/hock_schittkowski.json";
  if (!fs::exists(path)) GTEST_SKIP() << "needs " << path;
  const ProblemSet set = read_expression_file(path);
  EXPECT_EQ(set.problems.size(), 20U);
  const auto solver = make_solver("ipopt");
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> away(-0.3, 0.3);
  for (const BenchProblem& p : set.problems) {
    SCOPED_TRACE(p.name);
    Eigen::VectorXd x = p.start.x;
    for (double& entry : x) entry += away(generator);
    expect_derivatives(*p.problem, x);
    if (!solver->explain_unsupported(*p.problem).empty()) continue;
    const Result r = solver->solve(*p.problem, p.start, {}, {});
    EXPECT_LE(r.violation, 1e-6);
    EXPECT_NEAR(r.cost, *p.best_known, 1e-5 * std::max(1.0, std::abs(*p.best_known)));
  }
}

}  // namespace
}  // namespace prospect::expression_file_test
