// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/odometry_tree.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d deviations(const Matrix6d& covariance) {
  return covariance.diagonal().cwiseSqrt().asDiagonal();
}

}  // namespace

std::vector<GraphEdge> odometry_edges(const std::vector<KeyframeStep>& tree) {
  std::vector<GraphEdge> edges;
  for (std::size_t k = 1; k < tree.size(); ++k) {
    GraphEdge edge = loop_edge(tree[k].parent, static_cast<int>(k), tree[k].measured);
    edge.drift = deviations(tree[k].measured.information.inverse());
    edge.odometry = true;
    edges.push_back(edge);
  }
  return edges;
}

ReducedTree reduced_tree(const std::vector<KeyframeStep>& tree, std::vector<char> keep) {
  const std::size_t n = tree.size();
  std::vector<char> has_child(n, 0);
  keep[0] = 1;
  for (std::size_t k = 1; k < n; ++k) {
    const auto parent = static_cast<std::size_t>(tree[k].parent);
    if (has_child[parent]) keep[parent] = 1;
    has_child[parent] = 1;
  }
  ReducedTree result;
  result.anchor.assign(n, 0);
  result.T_anchor.assign(n, Isometry3d::Identity());
  result.kept = {0};
  std::vector<Matrix6d> covariance(n, Matrix6d::Zero()), drift(n, Matrix6d::Zero());
  for (std::size_t k = 1; k < n; ++k) {
    const auto parent = static_cast<std::size_t>(tree[k].parent);
    const RelativePose& step = tree[k].measured;
    const Matrix6d back = adjoint(step.T.inverse()), own = step.information.inverse();
    result.anchor[k] = result.anchor[parent];
    result.T_anchor[k] = result.T_anchor[parent] * step.T;
    covariance[k] = back * covariance[parent] * back.transpose() + own;
    drift[k] = back * drift[parent] + deviations(own);
    if (!keep[k]) continue;
    GraphEdge edge = loop_edge(result.anchor[k], static_cast<int>(result.kept.size()),
                               {result.T_anchor[k], covariance[k].inverse()});
    edge.drift = drift[k];
    edge.odometry = true;
    result.edges.push_back(edge);
    result.anchor[k] = static_cast<int>(result.kept.size());
    result.kept.push_back(static_cast<int>(k));
    result.T_anchor[k].setIdentity();
    covariance[k].setZero();
    drift[k].setZero();
  }
  return result;
}

}  // namespace prospect
