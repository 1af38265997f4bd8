// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/problem/problem.h"

namespace prospect {

/// The quadratic programme of a planning problem with bounds, solved stage by stage:
///
///   min_d  g^T d + 1/2 d^T (H + diag(h)) d + sum_{k=1..N} 1/2 dx_k^T P_k dx_k
///   s.t.   dx_{k+1} = A_k dx_k + B_k d_{knot(k)} + gap_k,   dx_0 = 0,   lower <= d <= upper
///
/// with the inputs d of the knots. H couples an input with those of its own knot and of the
/// knots beside it. It is the programme that condensing makes of sensitivities, without the dense
/// matrix: a round is one Riccati recursion over (dx_k, input of the knot before), of order
/// N (nx + nu)^3, in which the inputs that are taken to be at a bound are fixed, and one pass
/// forward, which gives the others and the multipliers of the fixed ones. Block principal pivoting
/// then exchanges all that are wrong at once; if three rounds lessen their number no further, only
/// the last of them, until it is less. That ends after a finite number of rounds, on R1 after eight
/// or nine from nothing. It begins with what was fixed at the end of the last solve.
///
/// Shapes: n = M nu variables, knot after knot; nx x N + 1 nodes; units are those of the problem.
/// A solve with nx = 3 and nu = 2 does not allocate. Thread-safety: none; an object a thread.
/// Deterministic: the result depends on the arguments and on the last solve alone.
///
/// Source: Rao, Wright and Rawlings (1998), "Application of interior-point methods to model
/// predictive control", for the recursion; Judice and Pires (1994), "A block principal pivoting
/// algorithm for large-scale strictly monotone linear complementarity problems".
class StageProgramme {
 public:
  enum class Status {
    kSolved,
    kNotOfStages,  ///< H couples knots that are not beside each other
    kNotConvex,    ///< the curvature by some input is not positive, or a number is not finite
    kStalled       ///< rounding keeps the pivoting from ending
  };

  explicit StageProgramme(const Problem& problem);

  /// A_k and B_k at states X (nx x (N+1)) and inputs z (n).
  void linearise(const Eigen::Ref<const Eigen::MatrixXd>& X,
                 const Eigen::Ref<const Eigen::VectorXd>& z);

  /// P: nx x (N+1) nx, node after node, positive semidefinite; H: n x n; h, g, lower <= 0 <= upper:
  /// n, finite; drift: nx x (N+1), e_{k+1} = A_k e_k + gap_k.
  Status solve(const Eigen::Ref<const Eigen::MatrixXd>& P,
               const Eigen::Ref<const Eigen::MatrixXd>& H,
               const Eigen::Ref<const Eigen::VectorXd>& h,
               const Eigen::Ref<const Eigen::VectorXd>& g,
               const Eigen::Ref<const Eigen::MatrixXd>& drift,
               const Eigen::Ref<const Eigen::VectorXd>& lower,
               const Eigen::Ref<const Eigen::VectorXd>& upper);

  /// d of the last solve that was kSolved.
  const Eigen::VectorXd& x() const { return x_; }
  /// The gradient of the programme's cost there: 0 but where d is at a bound, where it is the
  /// multiplier of the lower bound (>= 0) or that of the upper one, negative.
  const Eigen::VectorXd& multipliers() const { return multipliers_; }
  /// Riccati recursions of the last solve.
  int rounds() const { return rounds_; }

 private:
  template <int NX, int NU>
  bool recur(const Eigen::Ref<const Eigen::MatrixXd>& P, const Eigen::Ref<const Eigen::MatrixXd>& H,
             const Eigen::Ref<const Eigen::VectorXd>& h,
             const Eigen::Ref<const Eigen::VectorXd>& g);
  template <int NX, int NU>
  void go_forward();
  /// Fixes and frees what is wrong; false if nothing is.
  bool exchange(const Eigen::Ref<const Eigen::VectorXd>& lower,
                const Eigen::Ref<const Eigen::VectorXd>& upper, double size);

  const Problem& problem_;
  Eigen::Index nx_, nu_, n_;
  // By stage, side by side.
  Eigen::MatrixXd A_, B_, gap_;
  // By knot: u = Kx dx + Kv v + k with the input v of the knot before; the gradient of the cost to
  // go by u is Qx dx + C v + R u + r.
  Eigen::MatrixXd Kx_, Kv_, k_, Qx_, C_, R_, r_;
  Eigen::VectorXd x_, multipliers_, bound_;
  std::vector<signed char> side_;  // of each variable: -1 at its lower bound, 1 at its upper one
  std::vector<Eigen::Index> wrong_;
  std::size_t fewest_ = 0;
  int tries_ = 0, rounds_ = 0;
};

}  // namespace prospect
