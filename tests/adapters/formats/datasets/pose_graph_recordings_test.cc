// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "adapters/formats/datasets/g2o_file.h"
#include "adapters/missions/recordings/trajectory_error.h"
#include "perception/graph/pose_graph.h"

namespace prospect::pose_graph_recordings_test {
namespace {

// Loops of KITTI 05 and 06, four of five and seven of ten of them wrong.
TEST(PoseGraphRecordings, OfKittiNoWrongLoopIsUsed) {
  struct Case {
    const char* name;
    double error;  // [m], 1.1 times that with the right loops alone
    int right;     // loops, at least
  };
  for (const Case& c : {Case{"kitti_05", 1.1 * 3.19, 60}, Case{"kitti_06", 1.1 * 2.22, 45}}) {
    const std::string path = std::string(PROSPECT_SHARED_DATA) + "/pose_graphs/" + c.name;
    if (!std::filesystem::exists(path + "_GT.g2o")) GTEST_SKIP() << path << " is not there";
    const G2oGraph file = read_g2o(path + "_alpha_0.00.g2o");
    const auto truth = poses_of(read_g2o(path + "_GT.g2o"));
    const G2oOrder order = order_of(file);
    PoseGraph graph;
    ASSERT_EQ(graph.begin(order.first, Eigen::Isometry3d::Identity()), GraphInput::kTaken);
    for (const G2oOrder::Step& step : order.odometry) {
      ASSERT_EQ(graph.add_keyframe(step.id, step.from, step.measured), GraphInput::kTaken);
    }
    for (const std::size_t e : order.loops) {
      const G2oGraph::Edge& edge = file.edges[e];
      ASSERT_EQ(graph.add_loop(edge.from, edge.to, edge.measured), GraphInput::kTaken);
    }
    ASSERT_TRUE(graph.optimise());
    int right = 0, wrong = 0;
    for (std::size_t k = 0; k < order.loops.size(); ++k) {
      if (graph.loops()[k] != LoopState::kUsed) continue;
      const G2oGraph::Edge& edge = file.edges[order.loops[k]];
      const Eigen::Isometry3d T = truth.at(edge.from).inverse() * truth.at(edge.to);
      ++(T.translation().norm() <= 10.0 ? right : wrong);
    }
    EXPECT_EQ(wrong, 0) << c.name;
    EXPECT_GE(right, c.right) << c.name;
    std::vector<PosePair> pairs;
    for (const auto& [id, T] : truth) pairs.push_back({0.0, *graph.pose(id), T});
    EXPECT_LT(absolute_error(pairs, Alignment::kBestFit).rmse, c.error) << c.name;
  }
}

}  // namespace
}  // namespace prospect::pose_graph_recordings_test
