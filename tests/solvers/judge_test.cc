// SPDX-License-Identifier: Apache-2.0
#include "solvers/judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "problems/function_problem.h"
#include "tests/solvers/hostile_programmes.h"

namespace prospect::judge_test {
namespace {

using Vector = Eigen::VectorXd;
using Verdict = Judgement::Verdict;

Vector vec(std::initializer_list<double> values) {
  return Eigen::Map<const Vector>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

/// a x^2 + b y^2 within |x|, |y| <= 3.
FunctionProblem quadratic(double a, double b) {
  FunctionProblem p = hostile::boxed("quadratic", 2, 3.0, Vector::Zero(2));
  p.f = [=](const Vector& x) { return a * x[0] * x[0] + b * x[1] * x[1]; };
  p.g = [=](const Vector& x) { return vec({2.0 * a * x[0], 2.0 * b * x[1]}); };
  return p;
}

/// scale (x^3 + a y^2 + b y^3).
FunctionProblem inflection(double scale, double a, double b) {
  FunctionProblem p = quadratic(1.0, 1.0);
  p.f = [=](const Vector& x) {
    return scale * (x[0] * x[0] * x[0] + x[1] * x[1] * (a + b * x[1]));
  };
  p.g = [=](const Vector& x) {
    return Vector(scale * vec({3.0 * x[0] * x[0], x[1] * (2.0 * a + 3.0 * b * x[1])}));
  };
  return p;
}

/// The same, subject to x >= least and, if `ends`, x <= 0.
FunctionProblem bounded(double least, bool ends) {
  FunctionProblem p = quadratic(1.0, 1.0);
  p.rows = ends ? 2 : 1;
  p.c = [=](const Vector& x) { return ends ? vec({x[0] - least, -x[0]}) : vec({x[0] - least}); };
  p.J = [=](const Vector&) {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(ends ? 2 : 1, 2);
    J(0, 0) = 1.0;
    if (ends) J(1, 0) = -1.0;
    return J;
  };
  return p;
}

/// x subject to |unit (x - 1)^power| <= 1e-6 unit.
FunctionProblem narrow(double unit, int power) {
  FunctionProblem p = hostile::boxed("narrow", 1, 3.0, Vector::Zero(1));
  p.f = [](const Vector& x) { return x[0]; };
  p.g = [](const Vector&) { return vec({1.0}); };
  p.rows = 2;
  p.c = [=](const Vector& x) {
    const double h = std::pow(x[0] - 1.0, power);
    return vec({unit * (1e-6 + h), unit * (1e-6 - h)});
  };
  p.J = [=](const Vector& x) {
    const double d = unit * power * std::pow(x[0] - 1.0, power - 1);
    return Eigen::MatrixXd(vec({d, -d}));
  };
  return p;
}

TEST(Judge, SaysOfAPointWhatIsShown) {
  struct Case {
    const char* name;
    FunctionProblem programme;
    Vector at;
    Verdict verdict;
  };
  const std::vector<Case> cases = {
      {"minimum", quadratic(1.0, 1.0), vec({0.0, 0.0}), Verdict::kOptimum},
      {"slope", quadratic(1.0, 1.0), vec({1.0, 0.0}), Verdict::kDescent},
      {"saddle", quadratic(1.0, -1.0), vec({0.0, 0.0}), Verdict::kDescent},
      {"maximum", quadratic(-1.0, -1.0), vec({0.0, 0.0}), Verdict::kDescent},
      {"inflection", inflection(1.0, 0.0, 0.0), vec({0.0, 0.0}), Verdict::kDescent},
      {"inflection, small", inflection(1e-3, 0.0, 1.0), vec({0.0, 0.0}), Verdict::kDescent},
      {"inflection, large", inflection(1e6, 1e-3, 0.0), vec({0.0, 0.0}), Verdict::kDescent},
      {"inflections, unlike", inflection(1.0, 0.0, 1e4), vec({0.0, 0.0}), Verdict::kDescent},
      {"inflection on a bound", inflection(1.0, 1.0, 0.0), vec({-3.0, 0.0}), Verdict::kOptimum},
      {"corner of a maximum", quadratic(-1.0, -1.0), vec({3.0, -3.0}), Verdict::kOptimum},
      {"saddle on a bound", quadratic(-1.0, -1.0), vec({3.0, 0.0}), Verdict::kDescent},
      {"a variable that does not matter", quadratic(1.0, 0.0), vec({0.0, 1.0}), Verdict::kUnproven},
      {"on a constraint", bounded(1.0, false), vec({1.0, 0.0}), Verdict::kOptimum},
      {"off a constraint", bounded(1.0, false), vec({2.0, 0.0}), Verdict::kDescent},
      {"less would be violated", bounded(1.0, false), vec({0.5, 0.0}), Verdict::kLessens},
      {"at an equality", narrow(1.0, 1), vec({1.0 - 1e-6}), Verdict::kOptimum},
      {"in a small unit", narrow(1e-7, 1), vec({1.0 - 1e-6}), Verdict::kOptimum},
      {"whose gradient vanishes", narrow(1.0, 3), vec({0.99}), Verdict::kUnproven},
      {"more so", narrow(3.0, 5), vec({1.0 - std::pow(1e-6, 0.2)}), Verdict::kUnproven},
      {"no less can be violated", bounded(1.0, true), vec({0.5, 0.0}), Verdict::kInfeasible},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Judgement judged = judge(c.programme.problem(), c.at);
    EXPECT_EQ(judged.verdict, c.verdict) << judged.why;
    if (judged.verdict != Verdict::kDescent) continue;
    ASSERT_EQ(judged.better.size(), c.at.size());
    EXPECT_LT(c.programme.f(judged.better), c.programme.f(c.at) - 1e-5);
  }
}

}  // namespace
}  // namespace prospect::judge_test
