// SPDX-License-Identifier: Apache-2.0
#include "problems/expression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "problems/function_problem.h"

namespace prospect::expression_test {
namespace {

using ::testing::HasSubstr;

double at(const std::string& text, std::initializer_list<double> x) {
  return Expression(text, static_cast<int>(x.size())).value(vec(x));
}

std::string refusal(const std::string& text) {
  try {
    Expression(text, 2);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Expression, HasTheOrderOfOperationsOfMathematics) {
  EXPECT_EQ(at("1+2*3-4/2", {0.0}), 5.0);
  EXPECT_EQ(at("8-3-2", {0.0}), 3.0);
  EXPECT_EQ(at("16/4/2", {0.0}), 2.0);
  EXPECT_EQ(at("2^3^2", {0.0}), 512.0);
  EXPECT_EQ(at("-x1^2", {3.0}), -9.0);
  EXPECT_EQ(at("(-x1)^2", {3.0}), 9.0);
  EXPECT_EQ(at("2^-1", {0.0}), 0.5);
  EXPECT_EQ(at("3 * -x1", {2.0}), -6.0);
  EXPECT_EQ(at("1e-3*x2 + .5", {0.0, 1000.0}), 1.5);
  EXPECT_EQ(at("((x1))", {7.0}), 7.0);
}

TEST(Expression, HasItsFunctions) {
  EXPECT_EQ(at("sin(x1)+cos(x1)*tan(x1)", {0.3}), std::sin(0.3) + std::cos(0.3) * std::tan(0.3));
  EXPECT_EQ(at("exp(log(x1))-sqrt(x1)", {2.0}), std::exp(std::log(2.0)) - std::sqrt(2.0));
  EXPECT_TRUE(std::isnan(at("log(x1)", {-1.0})));
}

TEST(Expression, HasTheGradientOfItsValue) {
  for (const char* text :
       {"100*(x2-x1^2)^2+(1-x1)^2", "sin(x1+x2)+(x1-x2)^2-1.5*x1+2.5*x2+1", "log(1+x1^2)-x2",
        "x1/(1+x2^2)/3", "x1^x2", "exp(x1*x2)*cos(x1)-tan(x2/3)", "sqrt(1+x1^2+x2^4)",
        "-(x1-2)^3/x2", "(x1-2)^2*(x1-2)^5", "2^x1^2"}) {
    SCOPED_TRACE(text);
    const Expression e(text, 2);
    for (const auto& x : {vec({0.7, 1.3}), vec({1.9, 0.4}), vec({0.2, 2.1})}) {
      const Eigen::VectorXd gradient = e.gradient(x);
      for (int i = 0; i < 2; ++i) {
        const double h = 1e-5;
        Eigen::VectorXd ahead = x, behind = x;
        ahead[i] += h;
        behind[i] -= h;
        const double difference = (e.value(ahead) - e.value(behind)) / (2.0 * h);
        EXPECT_NEAR(gradient[i], difference, 1e-7 * std::max(1.0, std::abs(gradient[i])));
      }
    }
  }
  // A power of a negative base and of zero, with a constant exponent.
  EXPECT_EQ(Expression("x1^3", 1).gradient(vec({-2.0}))[0], 12.0);
  EXPECT_EQ(Expression("x1^2", 1).gradient(vec({0.0}))[0], 0.0);
}

TEST(Expression, SaysWhereItIsWrong) {
  EXPECT_THAT(refusal("x1+"), HasSubstr("at 4: unexpected end; expected a number"));
  EXPECT_THAT(refusal("x1 x2"), HasSubstr("at 4: unexpected 'x'; expected an operator"));
  EXPECT_THAT(refusal("(x1"), HasSubstr("expected ')'"));
  EXPECT_THAT(refusal("x3"), HasSubstr("at 1: unexpected 'x'; expected a number, x1 to x2"));
  EXPECT_THAT(refusal("x0"), HasSubstr("x1 to x2"));
  EXPECT_THAT(refusal("sin x1"), HasSubstr("expected '(' after sin"));
  EXPECT_THAT(refusal("1..2"), HasSubstr("expected an operator"));
  EXPECT_THAT(refusal("."), HasSubstr("expected a number"));
  EXPECT_THAT(refusal(""), HasSubstr("unexpected end"));
  EXPECT_THAT(refusal("system(1)"), HasSubstr("one of sin"));
  EXPECT_THAT(refusal(std::string(100000, '(')), HasSubstr("at most 200"));
  EXPECT_THAT(refusal(std::string(100000, '-') + "x1"), HasSubstr("accepted"));
}

}  // namespace
}  // namespace prospect::expression_test
