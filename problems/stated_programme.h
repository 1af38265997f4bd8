// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "problems/expression.h"

namespace prospect {

/// A nonlinear programme as expressions state it, before a Problem is made of it:
///
///   min objective(x)   s.t.   lower <= x <= upper,   row.lower <= row.body(x) <= row.upper
///
/// with infinite bounds where there are none, and equal ones for an equation.
struct StatedProgramme {
  struct Row {
    Expression body;
    double lower, upper;
  };
  std::string name;
  Eigen::VectorXd start, lower, upper;  ///< n; the start may lie outside the bounds
  Expression objective;
  std::vector<Row> rows;
  std::optional<double> optimum;  ///< the least cost, where somebody knows it
};

}  // namespace prospect
