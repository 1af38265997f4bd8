// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <utility>

namespace prospect {

/// A positive definite approximation B of the Hessian of a function, from its gradients at the last
/// points: for each pair s = x' - x, y = g' - g kept, oldest first,
///
///   B <- B - (B s)(B s)^T / (s^T B s) + y y^T / (s^T y),      B = (s^T y) / (s^T s) I of the
///   newest at first,
///
/// as a dense matrix, made anew each time: O(pairs n^2). The new scale at every update is why it
/// does better than one matrix that is updated all along, where the first scales were wrong. Pairs
/// without positive curvature, s^T y <= 1.5e-8 |s| |y|, are left out; two of them in a row drop all
/// others.
///
/// Source: Nocedal (1980); the rules are those of Ipopt's "limited-memory".
class LimitedMemoryBfgs {
 public:
  /// most: pairs kept, 1 or more.
  LimitedMemoryBfgs(int n, int most);

  void update(const Eigen::Ref<const Eigen::VectorXd>& s,
              const Eigen::Ref<const Eigen::VectorXd>& y);
  /// The identity before the first update.
  const Eigen::MatrixXd& matrix() const { return B_; }

 private:
  std::deque<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs_;
  std::size_t most_;
  int left_out_ = 0;
  Eigen::MatrixXd B_;
  Eigen::VectorXd Bs_;
};

}  // namespace prospect
