// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "perception/graph/graph_solver.h"

namespace prospect {

/// A graph to first order about an estimate: x = (xi_1, ..., xi_n-1, beta), poses T_k exp(xi_k)
/// moved along their directions(), the first one held. With the whitened errors r_e + J_e x,
///   H = sum J_e^T J_e + I / drift_sigma^2 (of beta),   x ~ N(., H^-1).
/// Edges must live as long as this does.
class LinearGraph {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  LinearGraph(const std::vector<const GraphEdge*>& edges, double drift_sigma,
              const GraphEstimate& estimate);

  /// Whether H could be decomposed; if not, nothing else may be asked.
  bool ok() const { return factor_.info() == Eigen::Success; }
  int size() const { return size_; }  ///< of x
  std::size_t edges() const { return rows_.size(); }

  /// Of standard normal z, size() long, a sample of N(0, H^-1).
  Eigen::VectorXd sample(const Eigen::VectorXd& z) const;

  /// The x for which  sum |J_e x - w_e|^2 + |beta / drift_sigma - w_beta|^2  is least.
  Eigen::VectorXd least_squares(const std::vector<Vector6d>& w, const Vector6d& w_beta) const;
  /// J_e x of the edge with that number.
  Vector6d whitened_change(std::size_t edge, const Eigen::VectorXd& x) const;
  /// r_e of it.
  const Vector6d& error(std::size_t edge) const { return rows_[edge].r; }
  /// J_e = by_b D of it, D x the change of T_a^-1 T_b.
  const Matrix6d& by_b(std::size_t edge) const { return rows_[edge].by_b; }

  /// How T_a^-1 T_b changes with x: D x = xi_b - Ad(T_b^-1 T_a) xi_a, in b.
  struct Change {
    int a = 0, b = 0;
    Matrix6d reach;  ///< Ad(T_b^-1 T_a)
  };
  Change change(int a, int b) const;
  /// D x.
  Vector6d value(const Change& change, const Eigen::VectorXd& x) const;
  /// H^-1 D^T.
  Eigen::Matrix<double, Eigen::Dynamic, 6> response(const Change& change) const;
  /// D H^-1 D'^T, D' the change whose response is given.
  Matrix6d covariance(const Change& change,
                      const Eigen::Matrix<double, Eigen::Dynamic, 6>& response) const;

 private:
  struct Row {
    const GraphEdge* edge;
    Change change;
    Matrix6d by_b;
    Vector6d r;
  };
  int at(int pose) const { return static_cast<int>(directions_.size()) * (pose - 1); }

  std::vector<Eigen::Isometry3d> poses_;
  std::vector<int> directions_;
  double drift_sigma_;
  int size_ = 0;
  std::vector<Row> rows_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace prospect
