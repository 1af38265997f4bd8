// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/linear_graph.h"

#include "perception/odometry/se3.h"

namespace prospect {

using Matrix6d = LinearGraph::Matrix6d;
using Vector6d = LinearGraph::Vector6d;

LinearGraph::LinearGraph(const std::vector<const GraphEdge*>& edges, double drift_sigma,
                         const GraphEstimate& estimate)
    : poses_(estimate.poses), directions_(estimate.directions()), drift_sigma_(drift_sigma) {
  const int n = static_cast<int>(directions_.size());
  size_ = n * static_cast<int>(poses_.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(4 * n * n) * edges.size());
  // The lower triangle.
  const auto add = [&](int row, int column, const Matrix6d& block) {
    for (int c = 0; c < n; ++c) {
      for (int r = row == column ? c : 0; r < n; ++r) {
        entries.emplace_back(row + r, column + c,
                             block(directions_[static_cast<std::size_t>(r)],
                                   directions_[static_cast<std::size_t>(c)]));
      }
    }
  };
  const int beta = size_ - n;
  for (const GraphEdge* edge : edges) {
    Row row;
    row.edge = edge;
    row.change = change(edge->a, edge->b);
    row.r = whitened_error(*edge, estimate, &row.by_b);
    const Matrix6d J[3] = {-row.by_b * row.change.reach, row.by_b, -edge->root * edge->drift};
    const int places[3] = {at(edge->a), at(edge->b), edge->odometry ? beta : -1};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        if (places[c] < 0 || places[r] < places[c]) continue;
        add(places[r], places[c], J[r].transpose() * J[c]);
      }
    }
    rows_.push_back(row);
  }
  add(beta, beta, Matrix6d::Identity() / (drift_sigma * drift_sigma));
  Eigen::SparseMatrix<double> H(size_, size_);
  H.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(H);
}

Eigen::VectorXd LinearGraph::sample(const Eigen::VectorXd& z) const {
  const Eigen::VectorXd y = factor_.matrixU().solve(z);
  return factor_.permutationPinv() * y;
}

Eigen::VectorXd LinearGraph::least_squares(const std::vector<Vector6d>& w,
                                           const Vector6d& w_beta) const {
  const int n = static_cast<int>(directions_.size());
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size_);
  for (std::size_t e = 0; e < rows_.size(); ++e) {
    const Row& row = rows_[e];
    const Vector6d of_b = row.by_b.transpose() * w[e];
    const Vector6d of_a = -row.change.reach.transpose() * of_b;
    const Vector6d of_beta = -row.edge->drift.transpose() * (row.edge->root.transpose() * w[e]);
    for (int k = 0; k < n; ++k) {
      const int direction = directions_[static_cast<std::size_t>(k)];
      if (row.edge->a > 0) g[at(row.edge->a) + k] += of_a[direction];
      if (row.edge->b > 0) g[at(row.edge->b) + k] += of_b[direction];
      if (row.edge->odometry) g[size_ - n + k] += of_beta[direction];
    }
  }
  for (int k = 0; k < n; ++k) {
    g[size_ - n + k] += w_beta[directions_[static_cast<std::size_t>(k)]] / drift_sigma_;
  }
  return factor_.solve(g);
}

Vector6d LinearGraph::whitened_change(std::size_t edge, const Eigen::VectorXd& x) const {
  const Row& row = rows_[edge];
  const int n = static_cast<int>(directions_.size());
  Vector6d result = row.by_b * value(row.change, x);
  if (row.edge->odometry) {
    Vector6d beta = Vector6d::Zero();
    for (int k = 0; k < n; ++k) beta[directions_[static_cast<std::size_t>(k)]] = x[size_ - n + k];
    result -= row.edge->root * (row.edge->drift * beta);
  }
  return result;
}

LinearGraph::Change LinearGraph::change(int a, int b) const {
  return {
      a, b,
      adjoint(poses_[static_cast<std::size_t>(b)].inverse() * poses_[static_cast<std::size_t>(a)])};
}

Vector6d LinearGraph::value(const Change& change, const Eigen::VectorXd& x) const {
  Vector6d of_a = Vector6d::Zero(), of_b = Vector6d::Zero();
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    if (change.a > 0) of_a[directions_[k]] = x[at(change.a) + static_cast<int>(k)];
    if (change.b > 0) of_b[directions_[k]] = x[at(change.b) + static_cast<int>(k)];
  }
  return of_b - change.reach * of_a;
}

Eigen::Matrix<double, Eigen::Dynamic, 6> LinearGraph::response(const Change& change) const {
  Eigen::Matrix<double, Eigen::Dynamic, 6> columns(size_, 6);
  columns.setZero();
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    const int row = static_cast<int>(k), direction = directions_[k];
    if (change.b > 0) columns(at(change.b) + row, direction) += 1.0;
    if (change.a > 0) columns.row(at(change.a) + row) -= change.reach.col(direction).transpose();
  }
  // The other columns are zero, as planar poses reach each other along these directions only.
  for (const int direction : directions_) {
    const Eigen::VectorXd column = columns.col(direction);
    columns.col(direction) = factor_.solve(column);
  }
  return columns;
}

Matrix6d LinearGraph::covariance(const Change& change,
                                 const Eigen::Matrix<double, Eigen::Dynamic, 6>& response) const {
  Matrix6d of_a = Matrix6d::Zero(), of_b = Matrix6d::Zero();
  for (std::size_t k = 0; k < directions_.size(); ++k) {
    const int row = static_cast<int>(k);
    if (change.a > 0) of_a.row(directions_[k]) = response.row(at(change.a) + row);
    if (change.b > 0) of_b.row(directions_[k]) = response.row(at(change.b) + row);
  }
  return of_b - change.reach * of_a;
}

}  // namespace prospect
