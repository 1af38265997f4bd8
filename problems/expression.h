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
/// ^ binds strongest and to the right (2^3^2 = 2^9, -x1^2 = -(x1^2)); spaces mean nothing; or given
/// by its operations, of which there are more. Value and gradient are exact to rounding: the
/// gradient is one backward sweep over the operations. Where the function is not defined (log of a
/// negative number), they are not finite.
///
/// Thread-safety: const calls from any thread.
class Expression {
 public:
  enum class Operation : unsigned char {
    kNumber,
    kVariable,  ///< a: its index, from 0
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
    kSqrt,
    kAbs,
    kTanh,
    kSinh,
    kCosh,
    kAsin,
    kAcos,
    kAtan,
    kAsinh,
    kAcosh,
    kAtanh,
    kLog10,
    kAtan2,      ///< of a by b
    kMinimum,    ///< of a and b
    kMaximum,    ///< of a and b
    kLess,       ///< 1 where a < b, else 0, and so the next five
    kLessEqual,  ///< a <= b
    kEqual,      ///< a = b
    kAnd,        ///< a and b are not 0
    kOr,         ///< a or b is not 0
    kNot,        ///< a is 0
    kIf          ///< b where a is not 0, else c; the other one counts for nothing
  };
  static constexpr int kOperations = static_cast<int>(Operation::kIf) + 1;
  struct Node {
    Operation operation;
    int a = 0, b = 0, c = 0;  ///< nodes before this one
    double number = 0.0;      ///< of kNumber
    friend bool operator==(const Node&, const Node&) = default;
  };
  /// How many of a, b and c are nodes.
  static int operands(Operation operation);

  /// Throws std::invalid_argument, "at 5: unexpected ')'; expected ...", counting characters
  /// from 1.
  Expression(const std::string& text, int variables);
  /// Operands before operators; the last node is the result. A node may be the operand of several.
  /// Throws std::invalid_argument for none, and for one that is no such node or variable.
  Expression(std::vector<Node> nodes, int variables);

  double value(const Eigen::VectorXd& x) const;
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const;

  int variables() const { return variables_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// The indices of the variables that it depends on, rising.
  std::vector<int> dependencies() const;

 private:
  friend class ExpressionParser;
  std::vector<double> values(const Eigen::VectorXd& x) const;

  int variables_;
  std::vector<Node> nodes_;
};

}  // namespace prospect
