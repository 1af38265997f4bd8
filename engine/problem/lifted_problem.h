// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/problem/problem.h"

namespace prospect {

/// Where a matrix can be nonzero, column by column: `rows` of column j are rows[starts[j]] to
/// rows[starts[j + 1] - 1], rising.
struct ColumnPattern {
  int height = 0;
  std::vector<int> starts = {0};  ///< one more than there are columns
  std::vector<int> rows;

  int width() const { return static_cast<int>(starts.size()) - 1; }
  int nonzeros() const { return static_cast<int>(rows.size()); }
  /// The place of an entry among the nonzeros; -1: it is always zero.
  int place(int row, int column) const;
};

/// The pattern of Problem::jacobian_pattern().
ColumnPattern column_pattern(const Problem& problem);

/// A problem whose states are variables, too, as multiple shooting and direct transcription have
/// it: each row depends on a stage or two, so that the Jacobian is sparse.
///
///   w = (z, x_1, ..., x_N),   min f(w)   s.t.   f_k(x_k, u_k) - x_{k+1} = 0, k = 0..N-1,
///                                              c(x, u) >= 0,   lower <= z <= upper
///
/// u_k = z[knot(k)], x_0 is given. Rows: nx of each k, then those of c as the problem has them.
/// Sizes: n + N nx variables, N nx + m rows. Thread-safety: const calls from any thread.
/// Source: Bock, Plitt, "A multiple shooting algorithm" (1984).
class LiftedProblem {
 public:
  /// Throws std::invalid_argument for a problem without gradients.
  explicit LiftedProblem(std::shared_ptr<const Problem> problem);

  int num_variables() const { return static_cast<int>(lower_.size()); }
  int num_constraints() const { return pattern_.height; }
  /// Infinite for the states.
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  /// Of the Jacobian.
  const ColumnPattern& pattern() const { return pattern_; }
  /// w of the states that the inputs z lead to.
  Eigen::VectorXd lifted(const Eigen::Ref<const Eigen::VectorXd>& z) const;

  struct Value {
    double cost = 0.0;
    Eigen::VectorXd gradient, constraints;
    Eigen::VectorXd jacobian;  ///< its nonzeros, as pattern() has them
  };
  /// False where some term is not evaluable. Allocates. Passes on exceptions of terms.
  bool evaluate(const Eigen::Ref<const Eigen::VectorXd>& w, Value& out) const;

 private:
  int state_column(int node) const {
    return problem_->num_variables() + (node - 1) * problem_->horizon().nx();
  }
  void evaluate_dynamics(const TrajectoryBatch& t, Value& out) const;
  void add_cost(const TermOutput& o, double weight, Value& out) const;
  void add_constraint(const TermOutput& o, const std::vector<JacobianBlock>& blocks, int first,
                      Value& out) const;
  void add(int row, int column, double value, Value& out) const {
    out.jacobian[pattern_.place(row, column)] += value;
  }

  std::shared_ptr<const Problem> problem_;
  Eigen::VectorXd lower_, upper_;
  ColumnPattern pattern_;
};

}  // namespace prospect
