// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace prospect {

/// A real function of x1..xn, written as text:
///
///   numbers, x1..xn, + - * / ^, ( ), and sin cos tan exp log sqrt of one argument
///
/// ^ binds strongest and to the right (2^3^2 = 2^9, -x1^2 = -(x1^2)); spaces mean nothing. Value
/// and gradient are exact to rounding: the gradient is one backward sweep over the operations.
/// Where the function is not defined (log of a negative number), they are not finite.
///
/// Thread-safety: const calls from any thread.
class Expression {
 public:
  /// Throws std::invalid_argument, "at 5: unexpected ')'; expected ...", counting characters
  /// from 1.
  Expression(const std::string& text, int variables);

  double value(const Eigen::VectorXd& x) const;
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;

 private:
  friend class ExpressionParser;
  enum class Operation {
    kNumber,
    kVariable,
    kNegate,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kPower,
    kSin,
    kCos,
    kTan,
    kExp,
    kLog,
    kSqrt
  };
  struct Node {
    Operation operation;
    int a = 0, b = 0;     ///< nodes before this one; a variable: its index in a
    double number = 0.0;  ///< of kNumber
  };
  std::vector<double> values(const Eigen::VectorXd& x) const;

  int variables_;
  std::vector<Node> nodes_;  ///< operands before operators; the last one is the result
};

}  // namespace prospect
