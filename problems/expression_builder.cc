// SPDX-License-Identifier: Apache-2.0
#include "problems/expression_builder.h"

#include <utility>

namespace prospect {

Expression part_of(const std::vector<Expression::Node>& nodes, int result, int variables) {
  const auto index = [](int node) { return static_cast<std::size_t>(node); };
  std::vector<int> place(index(result) + 1, -1);
  place[index(result)] = 0;
  const auto each_operand = [&](Expression::Node& node, const auto& act) {
    const int count = Expression::operands(node.operation);
    if (count > 0) act(node.a);
    if (count > 1) act(node.b);
    if (count > 2) act(node.c);
  };
  for (std::size_t i = index(result) + 1; i-- > 0;) {
    Expression::Node node = nodes[i];
    if (place[i] < 0) continue;
    each_operand(node, [&](int& operand) { place[index(operand)] = 0; });
  }
  std::vector<Expression::Node> needed;
  for (std::size_t i = 0; i <= index(result); ++i) {
    if (place[i] < 0) continue;
    place[i] = static_cast<int>(needed.size());
    needed.push_back(nodes[i]);
    each_operand(needed.back(), [&](int& operand) { operand = place[index(operand)]; });
  }
  return {std::move(needed), variables};
}

Expression ExpressionBuilder::finish(Formula result) const {
  return part_of(nodes_, result.node_, variables_);
}

}  // namespace prospect
