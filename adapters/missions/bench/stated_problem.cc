// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/stated_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "problems/function_problem.h"
#include "solvers/typical_change.h"

namespace prospect {
namespace {

constexpr double kFarBound = 100.0;  // beyond the start, where none is stated
constexpr double kEqualityBand = 1e-6;
constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// c(x) as rows factor * (expression - from) + shift >= 0.
struct Row {
  const Expression* expression;
  double factor, from, shift;
};

/// What a typical change of the variables changes h - b by, or its value, if that is more, at
/// points around the start: the unit of an equation, of which a band is a share. 1 where that is a
/// plain unit everywhere.
double unit_of(const Expression& h, double b, const FunctionProblem& p) {
  const Eigen::VectorXd start = p.start.cwiseMax(p.lower).cwiseMin(p.upper);
  const Eigen::VectorXd s = typical_change(start, p.lower, p.upper);
  double largest = 0.0, least = std::numeric_limits<double>::infinity();
  for (const double share : {0.0, -1.0, -0.3, 0.2, 0.7}) {
    const Eigen::VectorXd x = (start + share * s).cwiseMax(p.lower).cwiseMin(p.upper);
    const double change = h.gradient(x).cwiseProduct(s).lpNorm<Eigen::Infinity>();
    const double size = std::max(std::abs(h.value(x) - b), change);
    if (!std::isfinite(size) || size == 0.0) continue;
    largest = std::max(largest, size);
    least = std::min(least, size);
  }
  if (largest > 0.0 && largest < kSmallestUnit) return largest;
  return std::isfinite(least) && least > kLargestUnit ? least : 1.0;
}

/// Puts bounds `far` beyond the start where there are none.
void bound(const StatedProgramme& stated, double far, FunctionProblem& p) {
  const double from = stated.start.cwiseAbs().maxCoeff();
  p.lower = stated.lower;
  p.upper = stated.upper;
  for (Eigen::Index i = 0; i < p.lower.size(); ++i) {
    // What is stated may be farther out than the start.
    if (stated.lower[i] == -kNoBound) p.lower[i] = std::min(-from, stated.upper[i]) - far;
    if (stated.upper[i] == kNoBound) p.upper[i] = std::max(from, stated.lower[i]) + far;
  }
}

std::vector<Row> rows_of(const StatedProgramme& stated, const FunctionProblem& p) {
  std::vector<Row> rows;
  for (const StatedProgramme::Row& row : stated.rows) {
    if (row.lower == row.upper) {
      const double unit = unit_of(row.body, row.lower, p);
      rows.push_back({&row.body, 1.0 / unit, row.lower, kEqualityBand});
      rows.push_back({&row.body, -1.0 / unit, row.lower, kEqualityBand});
      continue;
    }
    if (row.lower != -kNoBound) rows.push_back({&row.body, 1.0, row.lower, 0.0});
    if (row.upper != kNoBound) rows.push_back({&row.body, -1.0, row.upper, 0.0});
  }
  return rows;
}

}  // namespace

BenchProblem stated_problem(StatedProgramme programme) {
  const auto stated = std::make_shared<const StatedProgramme>(std::move(programme));
  FunctionProblem p;
  p.name = stated->name;
  p.start = stated->start;
  bound(*stated, kFarBound, p);
  p.f = [stated](const Eigen::VectorXd& x) { return stated->objective.value(x); };
  p.g = [stated](const Eigen::VectorXd& x) { return stated->objective.gradient(x); };
  const std::vector<Row> rows = rows_of(*stated, p);
  p.rows = static_cast<int>(rows.size());
  // The rows of a range or an equation stand one after the other, and have one body.
  const auto again = [rows](std::size_t r) {
    return r > 0 && rows[r - 1].expression == rows[r].expression;
  };
  p.c = [stated, rows, again](const Eigen::VectorXd& x) {
    Eigen::VectorXd c(static_cast<Eigen::Index>(rows.size()));
    double value = 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (!again(r)) value = rows[r].expression->value(x);
      c[static_cast<Eigen::Index>(r)] = rows[r].factor * (value - rows[r].from) + rows[r].shift;
    }
    return c;
  };
  p.J = [stated, rows, again](const Eigen::VectorXd& x) {
    Eigen::MatrixXd J(static_cast<Eigen::Index>(rows.size()), x.size());
    Eigen::VectorXd gradient;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (!again(r)) gradient = rows[r].expression->gradient(x);
      J.row(static_cast<Eigen::Index>(r)) = rows[r].factor * gradient;
    }
    return J;
  };
  BenchProblem made = started(p.name, p.problem(), p.start, stated->optimum);
  for (int i = 0; i < static_cast<int>(p.start.size()); ++i) {
    if (stated->lower[i] == -kNoBound) made.no_lower.push_back(i);
    if (stated->upper[i] == kNoBound) made.no_upper.push_back(i);
  }
  made.with_bounds = [p, stated](double far) {
    FunctionProblem wider = p;
    bound(*stated, far, wider);
    return std::make_shared<const Problem>(wider.problem());
  };
  made.stated = [stated] { return *stated; };
  return made;
}

}  // namespace prospect
