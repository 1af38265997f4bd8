// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/map_projection.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace prospect::map_projection_test {
namespace {

TEST(MapProjection, LayersOfASlice) {
  // 0.3 - 0.2 is a little less than 0.1 in floating point: still layer 1 to 4, not 0 to 4.
  SliceLayers layers = slice_layers({0.3 - 0.2, 0.3 + 0.2}, 0.1);
  EXPECT_EQ(layers.k_low, 1);
  EXPECT_EQ(layers.k_high, 4);
  layers = slice_layers({0.05, 0.5001}, 0.1);
  EXPECT_EQ(layers.k_low, 0);
  EXPECT_EQ(layers.k_high, 5);
  layers = slice_layers({-0.2, -0.05}, 0.1);
  EXPECT_EQ(layers.k_low, -2);
  EXPECT_EQ(layers.k_high, -1);
  EXPECT_EQ(slice_layers({0.1, 0.1000001}, 0.1).count(), 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(slice_layers({0.5, 0.1}, 0.1), std::invalid_argument);
  EXPECT_THROW(slice_layers({nan, 0.1}, 0.1), std::invalid_argument);
  EXPECT_THROW(slice_layers({0.1, 0.5}, 0.0), std::invalid_argument);
  EXPECT_THROW(slice_layers({0.1, 0.5, {}, -0.1}, 0.1), std::invalid_argument);
  EXPECT_THROW(slice_layers({0.1, 0.5, {}, nan}, 0.1), std::invalid_argument);
}

TEST(MapProjection, ColumnRule) {
  for (const FloorState floor : {FloorState::kUnseen, FloorState::kThere}) {
    EXPECT_EQ(project_column(1, 3, floor), CellState::kOccupied);
    EXPECT_EQ(project_column(1, 0, floor), CellState::kOccupied);
    EXPECT_EQ(project_column(0, 1, floor), CellState::kFree);
    EXPECT_EQ(project_column(0, 0, floor), CellState::kUnknown);
  }
  EXPECT_EQ(project_column(0, 3, FloorState::kMissing), CellState::kOccupied);
  EXPECT_EQ(project_column(0, 0, FloorState::kMissing), CellState::kOccupied);
}

TEST(MapProjection, SightPassesFreeVoxelsAndUnknownOnesAboveFreeCells) {
  constexpr CellState kUnknown = CellState::kUnknown, kFree = CellState::kFree,
                      kOccupied = CellState::kOccupied;
  EXPECT_TRUE(see_through(kFree, kFree));
  EXPECT_TRUE(see_through(kOccupied, kFree));  // over a low obstacle
  EXPECT_TRUE(see_through(kFree, kUnknown));   // floor beyond the range at the eye's height
  EXPECT_FALSE(see_through(kFree, kOccupied));
  EXPECT_FALSE(see_through(kOccupied, kUnknown));
  EXPECT_FALSE(see_through(kUnknown, kUnknown));

  VoxelGrid voxels({0.1, 0, 0, 4, 1}, 0.0, 1.0);
  const SliceLayers layers = slice_layers({0.1, 0.5, 0.85}, 0.1);
  voxels.set(0, 0, 2, kFree);
  voxels.set(1, 0, 2, kFree);
  voxels.set(1, 0, 8, kOccupied);
  voxels.set(2, 0, 2, kOccupied);
  voxels.set(2, 0, 8, kFree);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(see_through(voxels, {i, 0}, layers), i == 0 || i == 2) << i;
}

TEST(MapProjection, OctreeToVoxelsMatchesSearchVoxelByVoxel) {
  std::mt19937_64 generator(1);
  std::uniform_int_distribution<int> address(-20, 20);
  std::uniform_real_distribution<float> value(-2.0F, 3.0F);
  octomap::OcTree tree(0.1);
  for (int n = 0; n < 3000; ++n) {
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(32768 + address(generator)),
                                 static_cast<octomap::key_type>(32768 + address(generator)),
                                 static_cast<octomap::key_type>(32768 + address(generator) / 2));
    tree.setNodeValue(key, value(generator));
  }
  // Large uniform blocks, so that leaves above the finest level are expanded.
  for (int i = -16; i < 0; ++i) {
    for (int j = 0; j < 16; ++j) {
      for (int k = 0; k < 8; ++k) {
        tree.setNodeValue(octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + i),
                                             static_cast<octomap::key_type>(32768 + j),
                                             static_cast<octomap::key_type>(32768 + k)),
                          -2.0F);
      }
    }
  }
  tree.prune();
  bool pruned = false;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    pruned |= leaf.getDepth() < tree.getTreeDepth();
  }
  ASSERT_TRUE(pruned);
  const VoxelGrid voxels = voxels_from_octree(tree, -0.5, 0.8);
  EXPECT_EQ(voxels.k0(), -5);
  EXPECT_EQ(voxels.depth(), 13);
  int known = 0;
  for (int i = -25; i <= 25; ++i) {
    for (int j = -25; j <= 25; ++j) {
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        const octomap::OcTreeNode* node = tree.search(octomap::OcTreeKey(
            static_cast<octomap::key_type>(32768 + i), static_cast<octomap::key_type>(32768 + j),
            static_cast<octomap::key_type>(32768 + k)));
        const CellState expected = node == nullptr             ? CellState::kUnknown
                                   : tree.isNodeOccupied(node) ? CellState::kOccupied
                                                               : CellState::kFree;
        ASSERT_EQ(voxels.state(i, j, k), expected) << i << ' ' << j << ' ' << k;
        known += node != nullptr;
      }
    }
  }
  EXPECT_GT(known, 2000);
}

TEST(MapProjection, BeliefMapsOfAnOctree) {
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  const auto set = [&](int i, int j, int k, float value) {
    tree->setNodeValue(octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + i),
                                          static_cast<octomap::key_type>(32768 + j),
                                          static_cast<octomap::key_type>(32768 + k)),
                       value);
  };
  for (int k = 1; k <= 4; ++k) set(3, 4, k, -1.0F);
  set(-2, 1, 1, -1.0F);
  set(-2, 1, 4, 1.0F);
  set(0, 0, 2, -1.0F);  // one of four layers only
  set(1, 0, 9, 1.0F);   // above the slice only
  const BeliefMaps maps = belief_maps(tree, {0.1, 0.5}, -0.3, 2.0);
  EXPECT_EQ(maps.octree, tree);
  EXPECT_EQ(maps.ground->state({3, 4}), CellState::kFree);
  EXPECT_EQ(maps.ground->state({-2, 1}), CellState::kOccupied);
  EXPECT_EQ(maps.ground->state({0, 0}), CellState::kFree);
  EXPECT_EQ(maps.ground->state({1, 0}), CellState::kUnknown);
  EXPECT_EQ(maps.voxels->state(1, 0, 9), CellState::kOccupied);
}

TEST(MapProjection, BadInputIsOneClearError) {
  EXPECT_THROW(belief_maps(nullptr, {}, 0.0, 1.0), std::invalid_argument);
  octomap::OcTree tree(0.1);
  EXPECT_THROW(voxels_from_octree(tree, 1.0, 0.0), std::invalid_argument);
  EXPECT_EQ(voxels_from_octree(tree, 0.0, 1.0).state(0, 0, 0), CellState::kUnknown);
  for (const float at : {0.05F, 9.95F}) tree.updateNode(octomap::point3d(at, at, 0.5F), true);
  EXPECT_EQ(voxels_from_octree(tree, 0.0, 1.0, 10'000).frame().size(), 10'000);
  EXPECT_THROW(voxels_from_octree(tree, 0.0, 1.0, 9'999), std::invalid_argument);
}

// One voxel 500 m off took 2.3 GB, one of 3 km was refused.
TEST(MapProjection, AVoxelFarAwayIsLeftOut) {
  for (const float far : {500.0F, -3000.0F}) {
    auto tree = std::make_shared<octomap::OcTree>(0.1);
    for (float x = 0.05F; x < 4.0F; x += 0.1F) {
      for (float y = 0.05F; y < 3.0F; y += 0.1F) tree->updateNode(x, y, 0.25F, false);
    }
    tree->updateNode(octomap::point3d(far, far, 0.25F), true);
    const BeliefMaps maps = belief_maps(tree, {0.1, 0.5}, 0.0, 1.0);
    EXPECT_EQ(maps.voxels->frame(), (GridFrame{0.1, 0, 0, 40, 30}));
    EXPECT_EQ(maps.ground->free_cells(), 1200);
    EXPECT_EQ(maps.ground->occupied_cells(), 0);
    EXPECT_EQ(maps.octree, tree);
  }
}

}  // namespace
}  // namespace prospect::map_projection_test
