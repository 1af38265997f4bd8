// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace prospect {

/// A strictly convex quadratic programme of few variables, solved by the dual method of active
/// sets:
///
///   min_x  1/2 x^T G x + g^T x    s.t.  A x + b >= 0,   lower <= x <= upper
///
/// The method starts at the minimum without constraints and adds violated constraints one by one;
/// multipliers stay >= 0 all the while, and one whose multiplier becomes zero is dropped. It ends
/// after a finite number of steps, at a point that fulfils the conditions of Karush, Kuhn and
/// Tucker to rounding. The constraints that were active at the end of the last solve are added
/// first, so a programme that is like the last one takes few steps.
///
/// Shapes: n variables, m rows of A; a bound may be infinite. One step is of order n (n + m); the
/// start is of order n^3. No allocation in a solve of a size that was solved before.
/// Thread-safety: none; an object a thread. Deterministic: the result depends on the arguments and
/// on the last active set alone.
///
/// Source: Goldfarb and Idnani (1983), "A numerically stable dual method for solving strictly
/// convex quadratic programs", Mathematical Programming 27.
class QuadraticProgram {
 public:
  enum class Status {
    kSolved,
    kInfeasible,  ///< no x fulfils all constraints
    kNotConvex,   ///< G is not positive definite to working precision, or not finite
    kStalled      ///< rounding keeps the method from ending
  };

  /// G: n x n symmetric, of which the lower triangle is read; g, lower, upper: n; A: m x n; b: m.
  /// A bound may be infinite, and lower <= upper.
  Status solve(const Eigen::Ref<const Eigen::MatrixXd>& G,
               const Eigen::Ref<const Eigen::VectorXd>& g,
               const Eigen::Ref<const Eigen::MatrixXd>& A,
               const Eigen::Ref<const Eigen::VectorXd>& b,
               const Eigen::Ref<const Eigen::VectorXd>& lower,
               const Eigen::Ref<const Eigen::VectorXd>& upper);

  /// Of the last solve that was kSolved.
  const Eigen::VectorXd& x() const { return x_; }
  /// Multipliers >= 0: of the rows of A (m), of the lower and of the upper bounds (n each).
  ///   G x + g = A^T multipliers + lower_multipliers - upper_multipliers
  const Eigen::VectorXd& multipliers() const { return multipliers_; }
  const Eigen::VectorXd& lower_multipliers() const { return lower_multipliers_; }
  const Eigen::VectorXd& upper_multipliers() const { return upper_multipliers_; }
  /// Steps of the last solve: constraints added and dropped.
  int steps() const { return steps_; }

 private:
  void resize(Eigen::Index n, Eigen::Index m);
  /// Adds the constraint with J^T normal = d_, which is independent of the active ones, to J and R.
  void add();
  /// Drops one of the active set.
  void drop(Eigen::Index position);
  /// Those of the active set, by constraint; all others are zero.
  void tell_multipliers();

  Eigen::VectorXd x_, multipliers_, lower_multipliers_, upper_multipliers_;
  int steps_ = 0;
  // J = L^{-T} Q, with G = L L^T; Q^T L^{-1} N = [R; 0] with the normals N of the active set.
  Eigen::MatrixXd L_, J_, R_;
  Eigen::VectorXd d_, z_, r_, norms_, row_values_;
  Eigen::VectorXd u_;  // of the active set
  std::vector<int> active_, last_active_;
  std::vector<char> is_active_;
};

}  // namespace prospect
