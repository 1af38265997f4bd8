// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/cloud_world.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "tests/adapters/mesh_files.h"
#include "tests/adapters/point_clouds.h"

namespace prospect::cloud_world_test {
namespace {

/// What is where in the room, by a point in the middle of each.
void expect_room(const World& world, const std::string& what) {
  const auto at = [&](double x, double y, double z) {
    const GridFrame& frame = world.voxels.frame();
    const Cell c = frame.cell(x, y);
    return world.voxels.state(c.i, c.j,
                              static_cast<int>(std::floor(z / world.voxels.resolution())));
  };
  EXPECT_EQ(at(2.0, 2.0, 0.3), CellState::kFree) << what;
  EXPECT_EQ(at(2.0, 2.0, -0.01), CellState::kOccupied) << what;
  EXPECT_EQ(at(5.5, 3.5, 1.5), CellState::kFree) << what;
  EXPECT_NE(at(0.02, 2.0, 0.5), CellState::kFree) << what;
  EXPECT_NE(at(3.0, 4.02, 1.0), CellState::kFree) << what;
  // What is noisy lies on both sides of a border of voxels.
  const bool crate =
      at(4.02, 1.5, 0.5) == CellState::kOccupied || at(3.98, 1.5, 0.5) == CellState::kOccupied;
  EXPECT_TRUE(crate) << what;
  EXPECT_NE(at(4.5, 1.5, 0.3), CellState::kFree) << what;
  EXPECT_NE(at(-1.0, 2.0, 0.3), CellState::kFree) << what;
  const double free = describe(world, {}).free_area;
  EXPECT_NEAR(free, 6.0 * 4.0 - 1.0, 2.5) << what;
}

World loaded(const std::vector<Eigen::Vector3d>& points, const WorldOptions& options = {}) {
  const test::Folder folder("cloud world");
  return load_world(folder.write("room.pcd", test::pcd(points, "binary")), options);
}

TEST(CloudWorld, RoomsOfAllKindsOfClouds) {
  const struct {
    const char* what;
    test::RoomPoints room;
    double resolution;
  } kRows[] = {{"fine", {}, 0.05},
               {"voxel centres", {.spacing = 0.1}, 0.1},
               {"noise of 1 cm", {.spacing = 0.03, .noise = 0.01}, 0.05},
               {"a floor 7.03 m up", {.floor = 7.03}, 0.05},
               {"a floor of -0.5 m on the border of steps", {.noise = 0.005, .floor = -0.5}, 0.05},
               {"no ceiling", {.with_ceiling = false}, 0.05},
               {"sparse", {.spacing = 0.14}, 0.2}};
  for (const auto& row : kRows) {
    const World world = loaded(row.room.points());
    expect_room(world, row.what);
    EXPECT_NEAR(world.source_floor_height, row.room.floor, 0.01) << row.what;
    EXPECT_EQ(world.voxels.resolution(), row.resolution) << row.what;
    EXPECT_TRUE(world.left_out.empty()) << row.what << ": " << world.left_out.text();
  }
}

TEST(CloudWorld, WithoutAFloorItIsWhatTheWallsEnclose) {
  const World world =
      loaded(test::RoomPoints{.floor = 0.4, .with_floor = false, .with_ceiling = false}.points());
  expect_room(world, "no floor");
  EXPECT_NE(world.left_out.text().find("a floor (there is none: taken at 0.4"), std::string::npos)
      << world.left_out.text();
}

TEST(CloudWorld, TheLowerFaceOfASlabIsNoFloor) {
  std::vector<Eigen::Vector3d> points = test::RoomPoints{.floor = 0.5}.points();
  for (double x = -0.2; x < 6.2; x += 0.04) {
    for (double y = -0.2; y < 4.2; y += 0.04) points.emplace_back(x, y, 0.0);
  }
  const World world = loaded(points);
  expect_room(world, "a slab");
  EXPECT_NEAR(world.source_floor_height, 0.5, 0.01);
}

TEST(CloudWorld, OptionsOfItsReading) {
  const std::vector<Eigen::Vector3d> points = test::RoomPoints().points();
  WorldOptions options;
  options.voxel_size = 0.2;
  EXPECT_EQ(loaded(points, options).voxels.resolution(), 0.2);
  // x up: the room's axes are the file's -y, -z, x.
  std::vector<Eigen::Vector3d> turned;
  for (const auto& p : points) turned.emplace_back(p.z(), -p.x(), -p.y());
  options = {};
  options.up = UpAxis::kX;
  expect_room(loaded(turned, options), "x up");
  // A second storey 3 m up.
  std::vector<Eigen::Vector3d> two = points;
  for (const auto& p : test::RoomPoints{.floor = 3.0}.points()) two.push_back(p);
  EXPECT_NEAR(loaded(two).source_floor_height, 0.0, 0.01);
  options = {};
  options.floor = 3.2;
  const World upper = loaded(two, options);
  expect_room(upper, "the upper storey");
  EXPECT_NEAR(upper.source_floor_height, 3.0, 0.01);
  options.floor = 30.0;
  EXPECT_THROW(loaded(two, options), InputError);
}

TEST(CloudWorld, WhatLiesFarOffIsLeftOut) {
  std::vector<Eigen::Vector3d> points = test::RoomPoints().points();
  points.emplace_back(500.0, 0.0, 1.0);
  const World world = loaded(points);
  expect_room(world, "a stray point");
  EXPECT_NE(world.left_out.text().find("1 points that nothing connects"), std::string::npos);
  // Beyond all that is measured, and where a cloud's corner would be taken to be.
  points.pop_back();
  for (const double off : {1e9, -1e300, 2e4, -2e4}) {
    points.emplace_back(1.0, off, 0.5);
    const World without = loaded(points);
    expect_room(without, "a point far off");
    EXPECT_NE(without.left_out.text().find("1 points "), std::string::npos)
        << without.left_out.text();
    EXPECT_EQ(without.left_out.text().find("origin"), std::string::npos) << without.left_out.text();
    points.pop_back();
  }
  points.emplace_back(500.0, 0.0, 1.0);
  // UTM; a PLY, as floats of 4 bytes cannot tell such positions.
  std::string ply = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size() - 1) +
                    "\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  points.pop_back();
  for (const auto& p : points) {
    ply += std::to_string(p.x() + 452000.0) + ' ' + std::to_string(p.y() + 5411000.0) + ' ' +
           std::to_string(p.z()) + '\n';
  }
  const test::Folder folder("cloud far");
  const World far = load_world(folder.write("far.ply", ply));
  expect_room(far, "UTM");
  EXPECT_NE(far.left_out.text().find("452000, 5411000"), std::string::npos) << far.left_out.text();
  EXPECT_THROW(loaded({{0, 0, 0}, {1, 0, 0}}), InputError);
  std::vector<Eigen::Vector3d> scattered;
  for (int n = 0; n < 200; ++n) scattered.emplace_back(1e30 * n, 0.0, 0.0);
  EXPECT_THROW(world_from_cloud({scattered}, "scattered"), InputError);
}

}  // namespace
}  // namespace prospect::cloud_world_test
