// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/programmes/joined_expressions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <tuple>

namespace prospect {
namespace {

using Node = Expression::Node;
using Operation = Expression::Operation;

bool is_comparison(Operation operation) {
  using enum Operation;
  return operation == kLess || operation == kLessEqual || operation == kEqual ||
         operation == kAnd || operation == kOr || operation == kNot;
}

}  // namespace

JoinedExpressions joined_expressions(const StatedProgramme& programme, int depth) {
  using Key = std::tuple<Operation, int, int, int, std::uint64_t>;
  std::map<Key, int> places;
  JoinedExpressions joined;
  const auto take = [&](const Expression& expression) {
    std::vector<int> place;
    for (Node node : expression.nodes()) {
      const int count = Expression::operands(node.operation);
      if (count > 0) node.a = place[static_cast<std::size_t>(node.a)];
      if (count > 1) node.b = place[static_cast<std::size_t>(node.b)];
      if (count > 2) node.c = place[static_cast<std::size_t>(node.c)];
      const Key key{node.operation, node.a, node.b, node.c,
                    std::bit_cast<std::uint64_t>(node.number)};
      const auto [found, is_new] = places.emplace(key, static_cast<int>(joined.nodes.size()));
      if (is_new) joined.nodes.push_back(node);
      place.push_back(found->second);
    }
    joined.results.push_back(place.back());
  };
  take(programme.objective);
  for (const StatedProgramme::Row& row : programme.rows) take(row.body);

  std::vector<int> uses(joined.nodes.size(), 0), deep(joined.nodes.size(), 0);
  for (const int result : joined.results) ++uses[static_cast<std::size_t>(result)];
  for (const Node& node : joined.nodes) {
    const std::array<int, 3> operands = {node.a, node.b, node.c};
    for (int i = 0; i < Expression::operands(node.operation); ++i) {
      ++uses[static_cast<std::size_t>(operands[static_cast<std::size_t>(i)])];
    }
  }
  joined.named.assign(joined.nodes.size(), false);
  for (std::size_t n = 0; n < joined.nodes.size(); ++n) {
    const Node& node = joined.nodes[n];
    const int count = Expression::operands(node.operation);
    if (count == 0) continue;
    const std::array<int, 3> operands = {node.a, node.b, node.c};
    for (int i = 0; i < count; ++i) {
      const auto operand = static_cast<std::size_t>(operands[static_cast<std::size_t>(i)]);
      if (!joined.named[operand]) deep[n] = std::max(deep[n], deep[operand] + 1);
    }
    joined.named[n] = !is_comparison(node.operation) && (uses[n] > 1 || deep[n] >= depth);
  }
  return joined;
}

}  // namespace prospect
