// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/g2o_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::g2o_file_test {
namespace {

using testing::HasSubstr;

class G2oFile : public testing::Test {
 protected:
  G2oGraph read(const std::string& text) {
    std::ofstream(path_) << text;
    return read_g2o(path_);
  }
  std::string problem(const std::string& text) {
    try {
      order_of(read(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void TearDown() override { std::filesystem::remove(path_); }
  const std::string path_ = testing::TempDir() + "g2o_file_test.g2o";
};

const std::string kInformation = " 100 1 0 100 2 400";
const std::string kUnit = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";

TEST_F(G2oFile, PlanarAndSpatialLinesAreRead) {
  const G2oGraph graph = read(
      "# a comment\n\nVERTEX_SE2 0 1 2 0.5\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\nFIX 0\n"
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"
      "EDGE_SE2  0 1 1.5 0.25 -0.1 " +
      kInformation +
      " \n"
      "EDGE_SE3:QUAT 1 0 1 2 3 0 0 0.6 0.8" +
      kUnit + "\n");
  EXPECT_EQ(graph.vertices.size(), 2u);
  ASSERT_EQ(graph.edges.size(), 2u);
  const RelativePose& planar = graph.edges[0].measured;
  EXPECT_EQ(planar.T.translation(), Eigen::Vector3d(1.5, 0.25, 0.0));
  EXPECT_EQ(planar.information(0, 1), 1.0);
  EXPECT_EQ(planar.information(1, 5), 2.0);
  EXPECT_EQ(planar.information(2, 2), 100.0);
  EXPECT_EQ(planar.information(3, 3), 400.0);
  EXPECT_NEAR(graph.edges[1].measured.T.linear()(0, 1), -0.96, 1e-12);
}

TEST_F(G2oFile, NeighboursAreOdometryAndTheRestAreLoops) {
  const auto edge = [](int a, int b, int x) {
    return "EDGE_SE2 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(x) +
           " 0 0" + kInformation + '\n';
  };
  // 7 follows 4; 9 is reached from 4, backwards; the second edge from 3 to 4 is a loop.
  const G2oGraph graph =
      read(edge(9, 4, 5) + edge(3, 4, 1) + edge(4, 7, 2) + edge(3, 4, 1) + edge(3, 9, 3));
  const G2oOrder order = order_of(graph);
  EXPECT_EQ(order.first, 3);
  ASSERT_EQ(order.odometry.size(), 3u);
  EXPECT_EQ(order.loops, (std::vector<std::size_t>{3, 4}));
  const auto poses = poses_of(graph);
  EXPECT_NEAR(poses.at(7).translation().x(), 3.0, 1e-12);
  EXPECT_NEAR(poses.at(9).translation().x(), -4.0, 1e-12);
}

TEST_F(G2oFile, WhatIsWrongIsALineWithItsPlace) {
  const std::string edge = "EDGE_SE2 0 1 1 0 0" + kInformation + '\n';
  EXPECT_EQ(problem(edge), "");
  EXPECT_THAT(problem(edge + "EDGE_SE2_XY 0 1 1 0 1 0 1\n"), HasSubstr(":2: 'EDGE_SE2_XY'"));
  EXPECT_THAT(problem("EDGE_SE2 0 1 1 0 nan" + kInformation), HasSubstr(":1: 'nan'; expected"));
  EXPECT_THAT(problem("EDGE_SE2 0 1 1 0" + kInformation), HasSubstr(":1: 10 numbers; expected 11"));
  EXPECT_THAT(problem("EDGE_SE2 0 -1 1 0 0" + kInformation), HasSubstr("'-1' as a vertex"));
  EXPECT_THAT(problem("EDGE_SE2 1 1 1 0 0" + kInformation), HasSubstr("to itself"));
  EXPECT_THAT(problem("EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1"), HasSubstr(":1: not an information"));
  EXPECT_THAT(problem("EDGE_SE2 0 1 1e9 0 0" + kInformation), HasSubstr("farther than"));
  EXPECT_THAT(problem("EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 0" + kUnit), HasSubstr(":1: not a pose"));
  EXPECT_THAT(problem(edge + "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0\n"),
              HasSubstr(":3: vertex 0 a second time"));
  EXPECT_THAT(problem(edge + "VERTEX_SE2 0 0 0 0\n"), HasSubstr(":1: vertex 1 is not in the file"));
  EXPECT_THAT(problem(edge + "FIX 5\n"), HasSubstr(":2: vertex 5 is not in the file"));
  EXPECT_THAT(problem(edge + "EDGE_SE2 5 6 1 0 0" + kInformation),
              HasSubstr("no way along edges from vertex 0 to vertex 5"));
  EXPECT_THAT(problem(""), HasSubstr("neither vertices nor edges"));
  EXPECT_THROW(read_g2o(path_ + ".none"), InputError);
}

}  // namespace
}  // namespace prospect::g2o_file_test
