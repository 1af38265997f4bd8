// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <vector>

namespace prospect {

/// Second derivatives of a cost of trajectories by the states, H_k = d^2 cost / d x_k^2 for each
/// node k, from gradients at neighbouring trajectories. Differences count what couples two nodes
/// with each of them, so that a motion of all nodes alike is seen as a whole.
///
/// Shapes: nx states, N + 1 nodes, n variables; units are those of the states. Node 0 is given and
/// left out. No allocation after the first use of a size. Thread-safety: none.
class StageCurvature {
 public:
  /// All zero.
  void reset(int nx, int nodes);
  /// nx x (N+1) nx, node after node.
  const Eigen::MatrixXd& hessians() const { return H_; }
  void set_hessians(const Eigen::Ref<const Eigen::MatrixXd>& hessians) { H_ = hessians; }

  /// Column i of each H_k by a forward difference: `moved` is the gradient with entry i of all
  /// states moved by `step`, `here` that without (nx x (N+1)).
  void difference(int i, double step, const Eigen::Ref<const Eigen::MatrixXd>& here,
                  const Eigen::Ref<const Eigen::MatrixXd>& moved);
  /// H_k <- (H_k + H_k^T) / 2, after the last column.
  void symmetrise();

  /// The symmetric rank-one formula: H_k s_k = y_k afterwards, with the change s of the states and
  /// y of the gradient by them (nx x (N+1)). Left out at a node where it is not defined or would be
  /// large.
  /// Source: Nocedal and Wright (2006), equation 6.24.
  void update(const Eigen::Ref<const Eigen::MatrixXd>& s,
              const Eigen::Ref<const Eigen::MatrixXd>& y);

  /// The projections P_k of H_k on matrices with eigenvalues of at least `least`: nx x (N+1) nx.
  /// Zero at a node of whose curvature nothing is known (H_k = 0).
  void project(double least);
  const Eigen::MatrixXd& projections() const { return P_; }

  /// Adds what the projections, those of project(least), say of the variables:
  ///   hessian += sum_k S_k^T P_k S_k,   gradient += sum_k S_k^T P_k e_k
  /// with the sensitivities S_k (nx x n) and the drift e (nx x (N+1)).
  void condense(double least, const std::vector<Eigen::MatrixXd>& sensitivity,
                const Eigen::Ref<const Eigen::MatrixXd>& drift, Eigen::MatrixXd& hessian,
                Eigen::VectorXd& gradient);

 private:
  Eigen::Index nx_ = 0;
  Eigen::MatrixXd H_, P_, PS_, node_;
  Eigen::VectorXd residual_;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen_;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen3_;  // faster, and most models have three
};

}  // namespace prospect
