// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/floor_state.h"

#include <gtest/gtest.h>

#include "engine/maps/map_projection.h"

namespace prospect::floor_state_test {
namespace {

TEST(FloorState, AFloorIsMissingWhereAllLayersOfTheStepAreFreeAndNothingIsMet) {
  EXPECT_EQ(floor_state(1, 0, 1), FloorState::kThere);
  EXPECT_EQ(floor_state(1, 2, 2), FloorState::kThere);  // a low thing above what is free
  EXPECT_EQ(floor_state(0, 2, 2), FloorState::kMissing);
  EXPECT_EQ(floor_state(0, 1, 2), FloorState::kUnseen);
  EXPECT_EQ(floor_state(0, 0, 1), FloorState::kUnseen);
}

TEST(FloorState, ItsLayersReachDownToTheStep) {
  EXPECT_EQ(floor_layer(0.0, 0.1), -1);
  EXPECT_EQ(floor_layer(0.05, 0.1), -1);
  EXPECT_EQ(floor_layer(0.1, 0.1), -2);  // onto the top of that layer
  EXPECT_EQ(floor_layer(0.12, 0.1), -2);
  EXPECT_EQ(floor_layer(0.3, 0.1), -4);  // 0.3 / 0.1 is less than 3
  EXPECT_EQ(floor_layer(0.05, 0.02), -3);
  EXPECT_EQ(floor_layer(1e300, 0.1), -1000001);
}

TEST(FloorState, OfAColumnOfVoxels) {
  VoxelGrid voxels({0.1, 0, 0, 6, 1}, -0.3, 1.0);
  const FloorLayers layers{-2, 1};
  for (int i = 0; i < 6; ++i) voxels.set(i, 0, 3, CellState::kFree);
  voxels.set(0, 0, -1, CellState::kOccupied);
  for (const int i : {1, 2, 4}) voxels.set(i, 0, -1, CellState::kFree);
  for (const int i : {1, 2}) voxels.set(i, 0, -2, CellState::kFree);
  voxels.set(1, 0, -3, CellState::kOccupied);  // too deep
  voxels.set(2, 0, 0, CellState::kOccupied);   // a threshold
  voxels.set(4, 0, -2, CellState::kOccupied);  // a step down that it takes
  const FloorState expected[] = {FloorState::kThere,  FloorState::kMissing, FloorState::kThere,
                                 FloorState::kUnseen, FloorState::kThere,   FloorState::kUnseen};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(floor_state(voxels, {i, 0}, layers), expected[i]) << i;
  EXPECT_EQ(floor_state(voxels, {6, 0}, layers), FloorState::kUnseen);
  // Layers that the grid does not have are not known to be free.
  EXPECT_EQ(floor_state(voxels, {1, 0}, {-4, 1}), FloorState::kThere);  // down to the -0.3 m
  voxels.set(1, 0, -3, CellState::kFree);
  EXPECT_EQ(floor_state(voxels, {1, 0}, {-4, 1}), FloorState::kUnseen);
}

TEST(FloorState, WhereItIsMissingTheGroundIsOccupiedAndSeenThrough) {
  VoxelGrid voxels({0.1, 0, 0, 3, 1}, -0.3, 1.0);
  for (int i = 0; i < 3; ++i) voxels.set(i, 0, 3, CellState::kFree);
  voxels.set(1, 0, -1, CellState::kFree);
  voxels.set(2, 0, -1, CellState::kOccupied);
  HeightSlice slice{0.1, 0.5, 0.35};
  const GroundMap ground = project(voxels, slice);
  EXPECT_EQ(ground.state({0, 0}), CellState::kFree);
  EXPECT_EQ(ground.state({1, 0}), CellState::kOccupied);
  EXPECT_TRUE(ground.see_through({1, 0}));
  EXPECT_EQ(ground.state({2, 0}), CellState::kFree);
  slice.step = 1000.0;  // it flies
  EXPECT_EQ(project(voxels, slice).state({1, 0}), CellState::kFree);
}

}  // namespace
}  // namespace prospect::floor_state_test
