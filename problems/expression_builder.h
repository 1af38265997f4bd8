// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "problems/expression.h"

namespace prospect {

/// Writes an expression as C++ does: what is used several times is one operation.
///
///   ExpressionBuilder e(2);
///   const auto r = e.x(1) - e.x(0) * e.x(0);
///   const Expression rosenbrock = e.finish(100.0 * r * r + (1.0 - e.x(0)) * (1.0 - e.x(0)));
///
/// Thread-safety: one thread.
class ExpressionBuilder {
 public:
  using Operation = Expression::Operation;
  /// A value of the builder that made it, which must live.
  class Formula {
   public:
    friend Formula operator+(Formula a, Formula b) { return a.with(Operation::kAdd, b); }
    friend Formula operator-(Formula a, Formula b) { return a.with(Operation::kSubtract, b); }
    friend Formula operator*(Formula a, Formula b) { return a.with(Operation::kMultiply, b); }
    friend Formula operator/(Formula a, Formula b) { return a.with(Operation::kDivide, b); }
    friend Formula operator<(Formula a, Formula b) { return a.with(Operation::kLess, b); }
    friend Formula operator+(Formula a, double b) { return a + a.number(b); }
    friend Formula operator-(Formula a, double b) { return a - a.number(b); }
    friend Formula operator*(Formula a, double b) { return a * a.number(b); }
    friend Formula operator/(Formula a, double b) { return a / a.number(b); }
    friend Formula operator<(Formula a, double b) { return a < a.number(b); }
    friend Formula operator+(double a, Formula b) { return b.number(a) + b; }
    friend Formula operator-(double a, Formula b) { return b.number(a) - b; }
    friend Formula operator*(double a, Formula b) { return b.number(a) * b; }
    friend Formula operator/(double a, Formula b) { return b.number(a) / b; }

   private:
    friend class ExpressionBuilder;
    Formula(ExpressionBuilder* builder, int node) : builder_(builder), node_(node) {}
    Formula with(Operation operation, Formula b) const {
      return builder_->add({operation, node_, b.node_, 0, 0.0});
    }
    Formula number(double value) const { return builder_->number(value); }
    ExpressionBuilder* builder_;
    int node_;
  };

  explicit ExpressionBuilder(int variables) : variables_(variables) {}
  Formula number(double value) { return add({Operation::kNumber, 0, 0, 0, value}); }
  /// The variable with that index, from 0.
  Formula x(int index) { return add({Operation::kVariable, index, 0, 0, 0.0}); }
  /// A function of one argument.
  Formula of(Operation operation, Formula a) { return add({operation, a.node_, 0, 0, 0.0}); }
  Formula choose(Formula condition, Formula then, Formula otherwise) {
    return add({Operation::kIf, condition.node_, then.node_, otherwise.node_, 0.0});
  }
  /// By halves, so that a long sum is not deep. 0 for none.
  Formula sum(std::vector<Formula> parts) {
    if (parts.empty()) return number(0.0);
    for (; parts.size() > 1; parts.resize((parts.size() + 1) / 2, parts.front())) {
      for (std::size_t i = 0; 2 * i < parts.size(); ++i) {
        parts[i] = 2 * i + 1 < parts.size() ? parts[2 * i] + parts[2 * i + 1] : parts[2 * i];
      }
    }
    return parts.front();
  }
  /// The expression of `result`: what that needs, and nothing else that was built.
  Expression finish(Formula result) const;

 private:
  Formula add(const Expression::Node& node) {
    nodes_.push_back(node);
    return {this, static_cast<int>(nodes_.size()) - 1};
  }
  int variables_;
  std::vector<Expression::Node> nodes_;
};

/// The operations that node `result` needs, in their order, as an expression of their own.
Expression part_of(const std::vector<Expression::Node>& nodes, int result, int variables);

}  // namespace prospect
