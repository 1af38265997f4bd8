// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perception/graph/graph_solver.h"
#include "perception/odometry/relative_pose.h"

namespace prospect {

/// How a keyframe was reached: measured from one that came before it in the tree. The first one has
/// no parent (-1).
struct KeyframeStep {
  int parent = -1;
  RelativePose measured;
};

/// The edges of a tree of odometry, from parent to keyframe, with drift = diag(sigma)
/// (GraphEstimate).
std::vector<GraphEdge> odometry_edges(const std::vector<KeyframeStep>& tree);

/// A tree with fewer keyframes: those kept, the first and those where it branches; what lies
/// between two of them is one edge. For steps T_k with noise n_k of covariance S_k,
///   T = prod T_k,   S = sum Ad_k S_k Ad_k^T,   drift = sum Ad_k diag(sigma_k),
/// Ad_k the adjoint of the way that is left after step k, back.
struct ReducedTree {
  std::vector<GraphEdge> edges;  ///< between numbers of kept keyframes
  std::vector<int> kept;         ///< keyframes of the tree, in its order
  std::vector<int> anchor;       ///< of each keyframe the last kept one on the way, by number
  std::vector<Eigen::Isometry3d> T_anchor;  ///< of each keyframe: its pose in the anchor
};
ReducedTree reduced_tree(const std::vector<KeyframeStep>& tree, std::vector<char> keep);

}  // namespace prospect
