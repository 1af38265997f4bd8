// SPDX-License-Identifier: Apache-2.0
#include "perception/graph/odometry_tree.h"

#include <gtest/gtest.h>

#include <vector>

#include "perception/graph/linear_graph.h"
#include "tests/perception/graph/two_laps.h"

namespace prospect::odometry_tree_test {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using test::TwoLaps;

TEST(OdometryTree, ReducedItIsAsSureAsInFull) {
  const TwoLaps laps(2, false);
  std::vector<KeyframeStep> tree(1);
  for (int k = 0; k < 60; ++k) tree.push_back({k, laps.odometry[static_cast<std::size_t>(k)]});
  tree.push_back({20, laps.odometry[20]});  // a branch
  std::vector<char> keep(tree.size(), 0);
  keep[10] = keep[60] = keep[61] = 1;
  const ReducedTree reduced = reduced_tree(tree, keep);
  EXPECT_EQ(reduced.kept, (std::vector<int>{0, 10, 20, 60, 61}));
  EXPECT_EQ(reduced.anchor[15], 1);
  GraphEstimate full, few;
  for (std::size_t k = 0; k < tree.size(); ++k) {
    full.poses.push_back(k == 0 ? laps.truth[0]
                                : full.poses[static_cast<std::size_t>(tree[k].parent)] *
                                      tree[k].measured.T);
  }
  for (const int k : reduced.kept) few.poses.push_back(full.poses[static_cast<std::size_t>(k)]);
  const auto covariance = [](const std::vector<GraphEdge>& edges, const GraphEstimate& x, int a,
                             int b) {
    std::vector<const GraphEdge*> pointers;
    for (const GraphEdge& edge : edges) pointers.push_back(&edge);
    const LinearGraph graph(pointers, 0.1, x);
    return graph.covariance(graph.change(a, b), graph.response(graph.change(a, b)));
  };
  const Matrix6d whole = covariance(odometry_edges(tree), full, 10, 60);
  const Matrix6d part = covariance(reduced.edges, few, 1, 3);
  EXPECT_LT((whole - part).norm(), 1e-8 * whole.norm());
  const Eigen::Isometry3d between = few.poses[1] * reduced.T_anchor[15];
  EXPECT_TRUE(between.isApprox(full.poses[15], 1e-12));
}

}  // namespace
}  // namespace prospect::odometry_tree_test
