// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/voxel_faces.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>

#include "adapters/views/page/binary_text.h"

namespace prospect::voxel_faces_test {
namespace {

struct Scene {
  octomap::OcTree tree{0.1};
  VoxelGrid voxels{GridFrame{0.1, -3, -2, 8, 7}, -0.2, 0.4};

  void fill(int i, int j, int k, double probability = 0.97) {
    voxels.set(i, j, k, CellState::kOccupied);
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + i),
                                 static_cast<octomap::key_type>(32768 + j),
                                 static_cast<octomap::key_type>(32768 + k));
    tree.setNodeValue(key, octomap::logodds(probability));
  }
};

/// Every exposed face, by axis, side, plane, u and v, with its level; each must be met once.
std::map<std::tuple<int, bool, int, int, int>, int> faces_of(
    const std::vector<FaceRectangle>& rectangles) {
  std::map<std::tuple<int, bool, int, int, int>, int> faces;
  for (const FaceRectangle& f : rectangles) {
    for (int v = f.v; v < f.v + f.height; ++v) {
      for (int u = f.u; u < f.u + f.width; ++u) {
        EXPECT_TRUE(faces.insert({{f.axis, f.up, f.layer, u, v}, f.level}).second) << "twice";
      }
    }
  }
  return faces;
}

TEST(VoxelFaces, ABoxHasSixRectangles) {
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 2; ++j) scene.fill(i, j, 0), scene.fill(i, j, 1);
  }
  const auto faces = merged_faces(scene.voxels, scene.tree);
  ASSERT_EQ(faces.size(), 6u);
  const std::array<std::array<int, 5>, 6> expected = {{{0, 0, 0, 2, 2},
                                                       {3, 0, 0, 2, 2},
                                                       {0, 0, 0, 2, 3},
                                                       {2, 0, 0, 2, 3},
                                                       {0, 0, 0, 3, 2},
                                                       {2, 0, 0, 3, 2}}};
  for (std::size_t n = 0; n < 6; ++n) {
    const FaceRectangle& f = faces[n];
    EXPECT_EQ(f.axis, static_cast<int>(n / 2));
    EXPECT_EQ(f.up, n % 2 == 1);
    EXPECT_EQ((std::array<int, 5>{f.layer, f.u, f.v, f.width, f.height}), expected[n]) << n;
    EXPECT_EQ(f.level, kOccupancyLevels - 1);
  }
}

TEST(VoxelFaces, EveryExposedFaceIsInExactlyOne) {
  Scene scene;
  std::mt19937 generator(3);
  const std::array<double, 4> probabilities = {0.55, 0.65, 0.8, 0.95};
  std::map<std::array<int, 3>, int> level;
  for (int i = -3; i < 5; ++i) {
    for (int j = -2; j < 5; ++j) {
      for (int k = -2; k < 4; ++k) {
        if (generator() % 5 < 2) continue;
        const int n = static_cast<int>(generator() % 4);
        level[{i, j, k}] = n;
        scene.fill(i, j, k, probabilities[static_cast<std::size_t>(n)]);
      }
    }
  }
  std::map<std::tuple<int, bool, int, int, int>, int> expected;
  for (const auto& [at, of] : level) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      for (const bool up : {false, true}) {
        std::array<int, 3> beside = at;
        beside[a] += up ? 1 : -1;
        if (level.contains(beside)) continue;
        expected[{axis, up, at[a] + up, at[(a + 1) % 3], at[(a + 2) % 3]}] = of;
      }
    }
  }
  const auto rectangles = merged_faces(scene.voxels, scene.tree);
  EXPECT_EQ(faces_of(rectangles), expected);
  EXPECT_LT(rectangles.size(), expected.size());
}

TEST(VoxelFaces, TextOfRectangles) {
  Scene scene;
  scene.fill(1, 2, 3);
  const auto faces = merged_faces(scene.voxels, scene.tree);
  BinaryText expected;  // of each side one: step of the layer, u, v, width and level, height
  for (const std::array<unsigned, 4>& f : std::array<std::array<unsigned, 4>, 6>{
           {{4, 4, 5, 3}, {5, 4, 5, 3}, {4, 5, 4, 3}, {5, 5, 4, 3}, {5, 4, 4, 3}, {6, 4, 4, 3}}}) {
    expected.add_varint(1);
    for (const unsigned number : f) expected.add_varint(number);
    expected.add_varint(0);
  }
  EXPECT_EQ(faces_text(faces, scene.voxels), expected.base64());
  const Scene empty;
  EXPECT_TRUE(merged_faces(empty.voxels, empty.tree).empty());
}

}  // namespace
}  // namespace prospect::voxel_faces_test
