// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "problems/stated_programme.h"

namespace prospect {

/// The operations of several expressions as one list, each operation once, however often it is
/// used; and which of them a text should give a name.
struct JoinedExpressions {
  std::vector<Expression::Node> nodes;  ///< operands before operators
  std::vector<int> results;             ///< the node of each expression
  std::vector<bool> named;              ///< by node: used twice or more, or deeper than `depth`
};

/// Of the objective, then of each row. depth: how deep what has no name may be. Comparisons, whose
/// values are no numbers in other formats, and numbers and variables have no name.
JoinedExpressions joined_expressions(const StatedProgramme& programme, int depth);

}  // namespace prospect
