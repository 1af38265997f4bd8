// SPDX-License-Identifier: Apache-2.0
#include "problems/expression.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
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
    into_.nodes_.push_back({operation, a, b, 0, number});
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

int Expression::operands(Operation operation) {
  using enum Operation;
  switch (operation) {
    case kNumber:
    case kVariable:
      return 0;
    case kAdd:
    case kSubtract:
    case kMultiply:
    case kDivide:
    case kPower:
    case kAtan2:
    case kMinimum:
    case kMaximum:
    case kLess:
    case kLessEqual:
    case kEqual:
    case kAnd:
    case kOr:
      return 2;
    case kIf:
      return 3;
    default:
      return 1;
  }
}

Expression::Expression(const std::string& text, int variables) : variables_(variables) {
  ExpressionParser(text, *this).run();
}

Expression::Expression(std::vector<Node> nodes, int variables)
    : variables_(variables), nodes_(std::move(nodes)) {
  if (nodes_.empty()) throw std::invalid_argument("expression: no operation; expected one or more");
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    const int before = static_cast<int>(i), count = operands(node.operation);
    const int places[] = {node.a, node.b, node.c};
    for (int k = 0; k < count; ++k) {
      if (places[k] < 0 || places[k] >= before) {
        throw std::invalid_argument("expression: operation " + std::to_string(i) + " uses " +
                                    std::to_string(places[k]) + "; expected one before it");
      }
    }
    if (node.operation == Operation::kVariable && (node.a < 0 || node.a >= variables_)) {
      throw std::invalid_argument("expression: variable " + std::to_string(node.a) +
                                  "; expected 0 to " + std::to_string(variables_ - 1));
    }
  }
}

std::vector<int> Expression::dependencies() const {
  std::vector<bool> seen(static_cast<std::size_t>(variables_), false);
  for (const Node& node : nodes_) {
    if (node.operation == Operation::kVariable) seen[static_cast<std::size_t>(node.a)] = true;
  }
  std::vector<int> found;
  for (int i = 0; i < variables_; ++i) {
    if (seen[static_cast<std::size_t>(i)]) found.push_back(i);
  }
  return found;
}

namespace {

double applied(Expression::Operation operation, double a, double b, double c) {
  using enum Expression::Operation;
  switch (operation) {
    case kNumber:
    case kVariable:
      break;
    case kNegate:
      return -a;
    case kAdd:
      return a + b;
    case kSubtract:
      return a - b;
    case kMultiply:
      return a * b;
    case kDivide:
      return a / b;
    case kPower:
      return std::pow(a, b);
    case kSin:
      return std::sin(a);
    case kCos:
      return std::cos(a);
    case kTan:
      return std::tan(a);
    case kExp:
      return std::exp(a);
    case kLog:
      return std::log(a);
    case kSqrt:
      return std::sqrt(a);
    case kAbs:
      return std::abs(a);
    case kTanh:
      return std::tanh(a);
    case kSinh:
      return std::sinh(a);
    case kCosh:
      return std::cosh(a);
    case kAsin:
      return std::asin(a);
    case kAcos:
      return std::acos(a);
    case kAtan:
      return std::atan(a);
    case kAsinh:
      return std::asinh(a);
    case kAcosh:
      return std::acosh(a);
    case kAtanh:
      return std::atanh(a);
    case kLog10:
      return std::log10(a);
    case kAtan2:
      return std::atan2(a, b);
    case kMinimum:
      return b < a ? b : a;
    case kMaximum:
      return b > a ? b : a;
    case kLess:
      return a < b ? 1.0 : 0.0;
    case kLessEqual:
      return a <= b ? 1.0 : 0.0;
    case kEqual:
      return a == b ? 1.0 : 0.0;
    case kAnd:
      return a != 0.0 && b != 0.0 ? 1.0 : 0.0;
    case kOr:
      return a != 0.0 || b != 0.0 ? 1.0 : 0.0;
    case kNot:
      return a == 0.0 ? 1.0 : 0.0;
    case kIf:
      return a != 0.0 ? b : c;
  }
  return 0.0;
}

/// d times the derivatives of the result v by a, b and c. constant: whether b is a number.
struct Slopes {
  double a = 0.0, b = 0.0, c = 0.0;
};
Slopes slopes(Expression::Operation operation, double d, double a, double b, double v,
              bool constant) {
  using enum Expression::Operation;
  switch (operation) {
    case kNegate:
      return {-d};
    case kAdd:
      return {d, d};
    case kSubtract:
      return {d, -d};
    case kMultiply:
      return {d * b, d * a};
    case kDivide:
      return {d / b, -(d * a / (b * b))};
    case kPower:
      // A constant exponent needs no logarithm, which a negative base has not.
      return {d * b * std::pow(a, b - 1.0), constant ? 0.0 : d * v * std::log(a)};
    case kSin:
      return {d * std::cos(a)};
    case kCos:
      return {-(d * std::sin(a))};
    case kTan:
      return {d * (1.0 + v * v)};
    case kExp:
      return {d * v};
    case kLog:
      return {d / a};
    case kSqrt:
      return {d / (2.0 * v)};
    case kAbs:
      return {a < 0.0 ? -d : d};
    case kTanh:
      return {d * (1.0 - v * v)};
    case kSinh:
      return {d * std::cosh(a)};
    case kCosh:
      return {d * std::sinh(a)};
    case kAsin:
      return {d / std::sqrt(1.0 - a * a)};
    case kAcos:
      return {-(d / std::sqrt(1.0 - a * a))};
    case kAtan:
      return {d / (1.0 + a * a)};
    case kAsinh:
      return {d / std::sqrt(a * a + 1.0)};
    case kAcosh:
      return {d / std::sqrt(a * a - 1.0)};
    case kAtanh:
      return {d / (1.0 - a * a)};
    case kLog10:
      return {d / (a * std::numbers::ln10)};
    case kAtan2:
      return {d * b / (a * a + b * b), -(d * a / (a * a + b * b))};
    case kMinimum:
      return b < a ? Slopes{0.0, d} : Slopes{d};
    case kMaximum:
      return b > a ? Slopes{0.0, d} : Slopes{d};
    case kIf:
      return a != 0.0 ? Slopes{0.0, d} : Slopes{0.0, 0.0, d};
    default:  // numbers and comparisons
      return {};
  }
}

}  // namespace

std::vector<double> Expression::values(const Eigen::VectorXd& x) const {
  std::vector<double> v(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.operation == Operation::kNumber) {
      v[i] = node.number;
    } else if (node.operation == Operation::kVariable) {
      v[i] = x[node.a];
    } else {
      // Operands that an operation has not are node 0.
      v[i] = applied(node.operation, v[static_cast<std::size_t>(node.a)],
                     v[static_cast<std::size_t>(node.b)], v[static_cast<std::size_t>(node.c)]);
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
    // What does not count has no derivative either, were it infinite: the other side of an `if`.
    if (d == 0.0 || node.operation == Operation::kNumber) continue;
    if (node.operation == Operation::kVariable) {
      gradient[node.a] += d;
      continue;
    }
    const auto a = static_cast<std::size_t>(node.a), b = static_cast<std::size_t>(node.b);
    const Slopes by =
        slopes(node.operation, d, v[a], v[b], v[i], nodes_[b].operation == Operation::kNumber);
    if (by.a != 0.0) adjoint[a] += by.a;
    if (by.b != 0.0) adjoint[b] += by.b;
    if (by.c != 0.0) adjoint[static_cast<std::size_t>(node.c)] += by.c;
  }
  return gradient;
}

}  // namespace prospect
