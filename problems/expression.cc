// SPDX-License-Identifier: Apache-2.0
#include "problems/expression.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

namespace prospect {

/// Recursive descent; each function appends nodes and returns the index of its result.
class ExpressionParser {
 public:
  ExpressionParser(const std::string& text, Expression& into) : text_(text), into_(into) {}

  void run() {
    sum();
    if (skip() != '\0') fail("an operator or the end");
  }

 private:
  using Operation = Expression::Operation;
  static constexpr int kMostDepth = 200;

  [[noreturn]] void fail(const std::string& expected) const {
    const std::string what =
        at_ < text_.size() ? std::string("unexpected '") + text_[at_] + "'" : "unexpected end";
    throw std::invalid_argument("at " + std::to_string(at_ + 1) + ": " + what + "; expected " +
                                expected);
  }
  char skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (skip() != c) return false;
    ++at_;
    return true;
  }
  int add(Operation operation, int a = 0, int b = 0, double number = 0.0) {
    into_.nodes_.push_back({operation, a, b, number});
    return static_cast<int>(into_.nodes_.size()) - 1;
  }

  int sum() {
    if (++depth_ > kMostDepth) fail("at most 200 parentheses within each other");
    int left = product();
    for (;;) {
      if (take('+')) {
        left = add(Operation::kAdd, left, product());
      } else if (take('-')) {
        left = add(Operation::kSubtract, left, product());
      } else {
        --depth_;
        return left;
      }
    }
  }
  int product() {
    int left = sign();
    for (;;) {
      if (take('*')) {
        left = add(Operation::kMultiply, left, sign());
      } else if (take('/')) {
        left = add(Operation::kDivide, left, sign());
      } else {
        return left;
      }
    }
  }
  int sign() {
    bool negative = false;
    for (;;) {
      if (take('-')) {
        negative = !negative;
      } else if (!take('+')) {
        break;
      }
    }
    const int operand = power();
    return negative ? add(Operation::kNegate, operand) : operand;
  }
  int power() {
    const int base = atom();
    if (!take('^')) return base;
    if (++depth_ > kMostDepth) fail("at most 200 powers within each other");
    const int exponent = sign();  // to the right
    --depth_;
    return add(Operation::kPower, base, exponent);
  }
  int atom() {
    const char c = skip();
    if (take('(')) {
      const int inner = sum();
      if (!take(')')) fail("')'");
      return inner;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      double number = 0.0;
      const char* first = text_.data() + at_;
      const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), number);
      if (error != std::errc()) fail("a number");
      at_ += static_cast<std::size_t>(end - first);
      return add(Operation::kNumber, 0, 0, number);
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string_view name = std::string_view(text_).substr(begin, at_ - begin);
    if (name.size() > 1 && name[0] == 'x') {
      int index = 0;
      const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), index);
      if (error == std::errc() && end == name.data() + name.size() && index >= 1 &&
          index <= into_.variables_) {
        return add(Operation::kVariable, index - 1);
      }
    }
    static constexpr std::pair<std::string_view, Operation> kFunctions[] = {
        {"sin", Operation::kSin}, {"cos", Operation::kCos}, {"tan", Operation::kTan},
        {"exp", Operation::kExp}, {"log", Operation::kLog}, {"sqrt", Operation::kSqrt}};
    for (const auto& [function, operation] : kFunctions) {
      if (name != function) continue;
      if (!take('(')) fail("'(' after " + std::string(function));
      const int argument = sum();
      if (!take(')')) fail("')'");
      return add(operation, argument);
    }
    at_ = begin;
    fail("a number, x1 to x" + std::to_string(into_.variables_) +
         ", '(' or one of sin, cos, tan, exp, log, sqrt");
  }

  const std::string& text_;
  Expression& into_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Expression::Expression(const std::string& text, int variables) : variables_(variables) {
  ExpressionParser(text, *this).run();
}

std::vector<double> Expression::values(const Eigen::VectorXd& x) const {
  std::vector<double> v(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.operation == Operation::kNumber) {
      v[i] = node.number;
      continue;
    }
    if (node.operation == Operation::kVariable) {
      v[i] = x[node.a];
      continue;
    }
    const double a = v[static_cast<std::size_t>(node.a)], b = v[static_cast<std::size_t>(node.b)];
    switch (node.operation) {
      case Operation::kNumber:
      case Operation::kVariable:
        break;
      case Operation::kNegate:
        v[i] = -a;
        break;
      case Operation::kAdd:
        v[i] = a + b;
        break;
      case Operation::kSubtract:
        v[i] = a - b;
        break;
      case Operation::kMultiply:
        v[i] = a * b;
        break;
      case Operation::kDivide:
        v[i] = a / b;
        break;
      case Operation::kPower:
        v[i] = std::pow(a, b);
        break;
      case Operation::kSin:
        v[i] = std::sin(a);
        break;
      case Operation::kCos:
        v[i] = std::cos(a);
        break;
      case Operation::kTan:
        v[i] = std::tan(a);
        break;
      case Operation::kExp:
        v[i] = std::exp(a);
        break;
      case Operation::kLog:
        v[i] = std::log(a);
        break;
      case Operation::kSqrt:
        v[i] = std::sqrt(a);
        break;
    }
  }
  return v;
}

double Expression::value(const Eigen::VectorXd& x) const { return values(x).back(); }

Eigen::VectorXd Expression::gradient(const Eigen::VectorXd& x) const {
  const std::vector<double> v = values(x);
  std::vector<double> adjoint(nodes_.size(), 0.0);
  adjoint.back() = 1.0;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(variables_);
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    const double d = adjoint[i];
    if (node.operation == Operation::kNumber) continue;
    if (node.operation == Operation::kVariable) {
      gradient[node.a] += d;
      continue;
    }
    const auto ia = static_cast<std::size_t>(node.a), ib = static_cast<std::size_t>(node.b);
    const double a = v[ia], b = v[ib];
    switch (node.operation) {
      case Operation::kNumber:
      case Operation::kVariable:
        break;
      case Operation::kNegate:
        adjoint[ia] -= d;
        break;
      case Operation::kAdd:
        adjoint[ia] += d;
        adjoint[ib] += d;
        break;
      case Operation::kSubtract:
        adjoint[ia] += d;
        adjoint[ib] -= d;
        break;
      case Operation::kMultiply:
        adjoint[ia] += d * b;
        adjoint[ib] += d * a;
        break;
      case Operation::kDivide:
        adjoint[ia] += d / b;
        adjoint[ib] -= d * a / (b * b);
        break;
      case Operation::kPower:
        adjoint[ia] += d * b * std::pow(a, b - 1.0);
        // A constant exponent needs no logarithm, which a negative base has not.
        if (nodes_[ib].operation != Operation::kNumber) adjoint[ib] += d * v[i] * std::log(a);
        break;
      case Operation::kSin:
        adjoint[ia] += d * std::cos(a);
        break;
      case Operation::kCos:
        adjoint[ia] -= d * std::sin(a);
        break;
      case Operation::kTan:
        adjoint[ia] += d * (1.0 + v[i] * v[i]);
        break;
      case Operation::kExp:
        adjoint[ia] += d * v[i];
        break;
      case Operation::kLog:
        adjoint[ia] += d / a;
        break;
      case Operation::kSqrt:
        adjoint[ia] += d / (2.0 * v[i]);
        break;
    }
  }
  return gradient;
}

}  // namespace prospect
