// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <random>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/formats/worlds/octree_world.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/ros_map.h"
#include "adapters/formats/worlds/world_file.h"
#include "tests/images/image_file.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::worlds_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A folder that is removed at the end of the test.
class Worlds : public ::testing::Test {
 protected:
  Worlds() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("worlds test ") + info->name());
    fs::create_directories(folder_);
  }
  ~Worlds() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  fs::path folder_;
};

/// The single line of the InputError that loading gives.
std::string refusal(const std::string& name, const WorldOptions& options = {}) {
  try {
    load_world(name, options);
  } catch (const InputError& e) {
    EXPECT_EQ(e.lines().size(), 1u) << e.what();
    EXPECT_THAT(e.what(), HasSubstr("expected"));
    return e.what();
  }
  ADD_FAILURE() << name << " was accepted";
  return "";
}

void expect_sound(const World& world) {
  const VoxelGrid& v = world.voxels;
  ASSERT_EQ(v.k0(), -1);
  const GridFrame& frame = v.frame();
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    if (v.state(c.i, c.j, 0) == CellState::kFree) {
      ASSERT_EQ(v.state(c.i, c.j, -1), CellState::kOccupied) << "no floor under free space";
    }
  }
  if (!world.texture_class.empty()) {
    ASSERT_EQ(world.texture_class.size(), v.data().size());
    for (const std::uint8_t c : world.texture_class) ASSERT_LT(c, world.texture_density.size());
  }
  const Grid<std::uint8_t> standing = standing_columns(v, {});
  ASSERT_EQ(standing.get(frame.cell(world.start.position.x(), world.start.position.y()), 0), 1);
  ASSERT_EQ(world.start.position.z(), 0.0);
}

std::string pgm(int width, int height, const std::string& pixels) {
  return "P5\n# made by a test\n" + std::to_string(width) + " " + std::to_string(height) +
         "\n255\n" + pixels;
}

/// A white room with a black wall, grey around.
std::string room_pixels(int width, int height, int white = 254, int grey = 205) {
  std::string pixels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int edge = std::min({x, y, width - 1 - x, height - 1 - y});
      pixels += static_cast<char>(edge < 5 ? grey : edge < 7 ? 0 : white);
    }
  }
  return pixels;
}

int count(const World& world, int k, CellState state) {
  int n = 0;
  const GridFrame& frame = world.voxels.frame();
  for (int m = 0; m < frame.size(); ++m) {
    n += world.voxels.state(frame.at(m).i, frame.at(m).j, k) == state;
  }
  return n;
}

// --- built-in worlds and world files
// ---------------------------------------------------------------

TEST_F(Worlds, BuiltInsAreSoundAndWhollyReachable) {
  const std::map<std::string, std::pair<double, double>> area = {{"office", {150, 200}},
                                                                 {"office_bare", {150, 200}},
                                                                 {"corridor", {110, 140}},
                                                                 {"loop", {90, 130}}};
  for (const std::string& name : builtin_world_names()) {
    const World world = load_world(name);
    expect_sound(world);
    EXPECT_EQ(world.name, name);
    EXPECT_EQ(world.voxels.resolution(), 0.1);
    EXPECT_FALSE(world.texture_class.empty());
    EXPECT_FALSE(builtin_world_summary(name).empty());
    const ReachableArea reachable = reachable_area(world);
    EXPECT_GT(reachable.area, area.at(name).first);
    EXPECT_LT(reachable.area, area.at(name).second);
    EXPECT_GT(reachable.area, 0.99 * describe(world, {}).free_area) << "a room cannot be entered";
  }
}

TEST_F(Worlds, BuiltInsCanBeCopiedAndEdited) {
  const World built_in = load_world("office");
  const World copy = load_world(write("office.yaml", builtin_world_text("office")));
  EXPECT_EQ(copy.voxels.data(), built_in.voxels.data());
  EXPECT_EQ(copy.texture_class, built_in.texture_class);
}

TEST_F(Worlds, CorridorHasAWhiteShortcutAndATexturedDetour) {
  const World world = load_world("corridor");
  const auto wall_above = [&](double x, double y) {
    Cell c = world.voxels.frame().cell(x, y);
    while (!world.solid(c.i, c.j, 5)) ++c.j;
    return texture_density(world, c.i, c.j, 5, 1);
  };
  EXPECT_EQ(wall_above(10.0, 3.0), 0.0);
  EXPECT_EQ(wall_above(10.0, 10.0), 40.0);
  EXPECT_EQ(texture_density(world, 100, 30, -1, 1), 0.0) << "the shortcut's floor is white, too";
  EXPECT_EQ(texture_density(world, 100, 100, -1, 1), 35.0);
}

TEST_F(Worlds, WorldFileLowersItsFloor) {
  const std::string rooms =
      "textures: {a: 1, b: 2}\n"
      "rooms: [{box: [0, 0, 3, 2], walls: a, floor: a}, {box: [3.2, 0, 5, 2], walls: a, floor: "
      "a}]\n"
      "doors: [{box: [2.9, 0.5, 3.3, 1.5]}]\n";
  const World flat = world_from_yaml(rooms, "w");
  const World world = world_from_yaml(rooms +
                                          "drops:\n"
                                          "  - {box: [1, 1, 2, 2], depth: 0.3, texture: b}\n"
                                          "  - {box: [1.5, 0, 2, 1.2], depth: 1}\n"
                                          "  - {box: [2.9, 0, 3.3, 9], depth: 0.01}\n",
                                      "w");
  EXPECT_EQ(flat.voxels.k0(), -1);
  EXPECT_EQ(world.voxels.k0(), -11);
  const auto floor = [&](double x, double y) {  // the layer of its surface
    const Cell c = world.voxels.frame().cell(x, y);
    int k = 0;
    while (!world.solid(c.i, c.j, k - 1)) --k;
    return k;
  };
  EXPECT_EQ(floor(0.5, 0.5), 0);
  EXPECT_EQ(floor(1.25, 1.5), -3);
  EXPECT_EQ(floor(1.75, 0.5), -10);
  EXPECT_EQ(floor(1.75, 1.1), -10);  // of two the deeper
  EXPECT_EQ(floor(3.1, 1.0), -1);    // in the doorway, a voxel at least
  EXPECT_EQ(texture_density(world, 12, 15, -4, 0), 2.0);
  EXPECT_EQ(texture_density(world, 17, 5, -11, 0), 1.0);
  // Its sides are solid, all else is as without drops.
  EXPECT_EQ(world.voxels.state(9, 15, -2), CellState::kOccupied);
  const GridFrame& f = world.voxels.frame();
  ASSERT_EQ(f, flat.voxels.frame());
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    for (int k = 0; k < flat.voxels.k0() + flat.voxels.depth(); ++k) {
      ASSERT_EQ(world.voxels.state(c.i, c.j, k), flat.voxels.state(c.i, c.j, k));
    }
  }
  // Nobody stands there, and what is seen of it does not count.
  const Grid<std::uint8_t> free = free_columns(world.voxels, {});
  EXPECT_EQ(free.get(f.cell(1.25, 1.5), 9), 0);
  EXPECT_EQ(free.get(f.cell(0.5, 0.5), 9), 1);
  BodySlice climber;
  climber.step = 0.3;
  EXPECT_EQ(free_columns(world.voxels, climber).get(f.cell(1.25, 1.5), 9), 1);
  EXPECT_EQ(free_columns(world.voxels, climber).get(f.cell(1.75, 0.5), 9), 0);
}

TEST_F(Worlds, DropsThatMakeNoSenseAreRefused) {
  const std::string rooms =
      "textures: {a: 1}\nrooms: [{box: [0, 0, 3, 2], walls: a, floor: a}]\ndrops: ";
  for (const char* drops :
       {"[{box: [0, 0, 1, 1]}]\n", "[{box: [0, 0, 1, 1], depth: 0}]\n", "[{depth: 1}]\n",
        "[{box: [1, 0, 1, 1], depth: 1}]\n", "[{box: [0, 0, 1, 1], depth: 1, texture: b}]\n",
        "[{box: [0, 0, 1, 1], depth: 1, deep: 2}]\n"}) {
    EXPECT_THAT(refusal(write("drops.yaml", rooms + drops)), HasSubstr("drops")) << drops;
  }
}

TEST_F(Worlds, WorldFileGivesEachSurfaceItsTexture) {
  const World world = world_from_yaml(
      "textures: {a: 1, b: 2, c: 3, d: 4, e: 5}\n"
      "rooms: [{box: [0, 0, 2, 2], walls: a, east: b, floor: c}]\n"
      "furniture: [{box: [1, 1, 1.3, 1.3], z: [0.2, 0.5], texture: d}]\n",
      "w");
  const auto at = [&](int i, int j, int k) { return texture_density(world, i, j, k, 0); };
  EXPECT_EQ(at(20, 10, 5), 2.0) << "east";
  EXPECT_EQ(at(-1, 10, 5), 1.0);
  EXPECT_EQ(at(10, 20, 5), 1.0);
  EXPECT_EQ(at(5, 5, -1), 3.0);
  EXPECT_EQ(at(11, 11, 3), 4.0);
  EXPECT_EQ(world.voxels.state(11, 11, 3), CellState::kOccupied);
  EXPECT_EQ(world.voxels.state(11, 11, 1), CellState::kFree) << "below the box";
  EXPECT_EQ(world.voxels.state(11, 11, 5), CellState::kFree) << "above it";
  EXPECT_EQ(world.voxels.state(21, 10, 0), CellState::kOccupied);
  EXPECT_EQ(world.voxels.state(22, 10, 0), CellState::kUnknown) << "beyond the wall";
}

TEST_F(Worlds, WorldFileReportsAllItsProblems) {
  const std::string file =
      write("bad.yaml",
            "resolution: .nan\ntextures: {brick: -1}\nrooms:\n  - {box: [2, 0, 1, 1], walls: brik, "
            "floor: brick}\n  - {box: [0, 0, 1], walls: brick, floor: brick, colour: red}\nstart: "
            "[0, 0]\n"
            "door: []\n");
  try {
    load_world(file);
    FAIL();
  } catch (const InputError& e) {
    const std::string all = e.what();
    EXPECT_EQ(e.lines().size(), 8u) << all;
    EXPECT_THAT(all, HasSubstr("bad.yaml:1: resolution: is '.nan'"));
    EXPECT_THAT(all, HasSubstr(":2: textures.brick: is '-1'"));
    EXPECT_THAT(all, HasSubstr("rooms[0].box: an empty box"));
    EXPECT_THAT(all, HasSubstr("is 'brik' (did you mean 'brick'?)"));
    EXPECT_THAT(all, HasSubstr("rooms[1].box: has 3 entries"));
    EXPECT_THAT(all, HasSubstr("unknown key 'rooms[1].colour'"));
    EXPECT_THAT(all, HasSubstr(":6: start: has 2 entries"));
    EXPECT_THAT(all, HasSubstr(":7: unknown key 'door' (did you mean 'doors'?)"));
  }
  EXPECT_THROW(load_world(write("empty.yaml", "")), InputError);
  EXPECT_THROW(world_from_yaml("resolution: 0.02\ntextures: {a: 1}\nrooms: [{box: [-1000, -1000, "
                               "1000, 1000], walls: a, floor: a}]\n",
                               "w"),
               InputError);
}

// --- start
// -----------------------------------------------------------------------------------------

TEST_F(Worlds, StartInsideAWallIsRefused) {
  WorldOptions options;
  options.start = Pose{{0.0, -0.1, 0.0}, 0.0};
  EXPECT_THAT(refusal("office", options), HasSubstr("lies inside a wall"));
  options.start = Pose{{10.0, 4.95, 0.0}, 0.0};
  EXPECT_THAT(refusal("office", options), HasSubstr("m of room"));
  EXPECT_THAT(refusal("office", options), HasSubstr("expected a place where the body"));
  options.start = Pose{{1e5, 0.0, 0.0}, 0.0};
  EXPECT_THAT(refusal("office", options), HasSubstr("outside the map"));
  options.start = Pose{{std::nan(""), 0.0, 0.0}, 0.0};
  EXPECT_THAT(refusal("office", options), HasSubstr("not finite"));
  options.start = Pose{{1.0, 5.3, 7.0}, 1.5};
  const World world = load_world("office", options);
  EXPECT_EQ(world.start.position.z(), 0.0);
  EXPECT_EQ(world.start.yaw, 1.5);
}

// A given start needs room for the body at its heading and no more.
TEST_F(Worlds, StartWithLittleRoomIsTaken) {
  const char* text =
      "resolution: 0.05\ntextures: {a: 1}\nrooms:\n  - {box: [0, 0, 4, 4], walls: a, floor: a}\n";
  const auto taken = [&](const RobotShape& shape, double x, double yaw) {
    World world = world_from_yaml(text, "w");
    BodySlice slice;
    slice.shape = shape;
    slice.standing_clearance = circumscribed_radius(shape) + 0.1;
    try {
      place_start(world, slice, Pose{{x, 2.0, 0.0}, yaw}, false);
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1u);
      return false;
    }
    return true;
  };
  EXPECT_TRUE(taken(CylinderShape{}, 0.26, 0.0));
  EXPECT_TRUE(taken(CylinderShape{}, 0.18, 0.0));
  EXPECT_FALSE(taken(CylinderShape{}, 0.17, 0.0));
  const BoxShape box{{0, 0, 0.3}, {0.9, 0.5, 0.4}};
  EXPECT_TRUE(taken(box, 0.26, M_PI / 2.0));
  EXPECT_FALSE(taken(box, 0.26, 0.0));
  EXPECT_TRUE(taken(box, 0.46, M_PI));
  EXPECT_FALSE(taken(box, 0.24, M_PI / 2.0));
}

TEST_F(Worlds, DefaultStartStandsInTheLargestSpace) {
  const World world = world_from_yaml(
      "textures: {a: 1}\nrooms:\n  - {box: [0, 0, 2, 2], walls: a, floor: a}\n"
      "  - {box: [10, 0, 16, 4], walls: a, floor: a}\n",
      "w");
  World placed = world;
  place_start(placed, {}, std::nullopt, false);
  EXPECT_NEAR(placed.start.position.x(), 13.0, 0.2);
  EXPECT_NEAR(placed.start.position.y(), 2.0, 0.2);
  BodySlice wide;
  wide.standing_clearance = 3.0;
  wide.shape = CylinderShape{{0, 0, 0.3}, 2.5, 0.4};
  EXPECT_THROW(place_start(placed, wide, std::nullopt, false), InputError);
  // Without ample room, wherever the body fits, at a heading at which it does: across here.
  wide.shape = BoxShape{{0, 0, 0.3}, {3.4, 5.4, 0.4}};
  place_start(placed, wide, std::nullopt, false);
  EXPECT_NEAR(placed.start.position.x(), 13.0, 0.2);
  EXPECT_NEAR(placed.start.yaw, M_PI / 2.0, 0.1);
}

TEST_F(Worlds, UnknownNamesAndPathsAreRefused) {
  EXPECT_THAT(refusal("ofice"), HasSubstr("unknown world 'ofice' (did you mean 'office'?)"));
  EXPECT_THAT(refusal("warehouse"),
              HasSubstr("expected one of: office, office_bare, corridor, loop"));
  EXPECT_THAT(refusal(""), HasSubstr("unknown world ''"));
  EXPECT_THAT(refusal(path("none.bt")), HasSubstr("no such file"));
  EXPECT_THAT(refusal(folder_.string()), HasSubstr("is a directory"));
  fs::create_directory(path("folder.bt"));
  EXPECT_THAT(refusal(path("folder.bt")), HasSubstr("is a directory"));
  EXPECT_THAT(refusal(write("x.txt", "x")), HasSubstr("unknown kind of file '.txt'"));
  for (const char* name : {"e.bt", "e.ot", "e.pgm", "e.png", "e.map"}) {
    EXPECT_THAT(refusal(write(name, "")), HasSubstr(std::string(name) + ": empty file"));
  }
}

// --- images
// ----------------------------------------------------------------------------------------

TEST_F(Worlds, RosMapIsExtruded) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string yaml =
      write("map.yaml",
            "image: map.pgm\nresolution: 0.1\norigin: [-1.04, 2, 0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.25\n");
  const World world = load_world(yaml);
  expect_sound(world);
  const GridFrame& frame = world.voxels.frame();
  EXPECT_EQ(frame.i0, -10);
  EXPECT_EQ(frame.j0, 20);
  EXPECT_EQ(frame.width, 60);
  EXPECT_EQ(frame.height, 50);
  EXPECT_EQ(world.voxels.depth(), 21) << "2 m and the floor";
  EXPECT_EQ(count(world, 0, CellState::kFree), 46 * 36);
  EXPECT_EQ(count(world, 19, CellState::kFree), 46 * 36);
  EXPECT_EQ(count(world, 0, CellState::kOccupied), 50 * 40 - 46 * 36);
  EXPECT_EQ(count(world, 0, CellState::kUnknown), 60 * 50 - 50 * 40) << "205 although below 0.25";
  EXPECT_EQ(count(world, -1, CellState::kOccupied), 50 * 40);
  EXPECT_TRUE(world.texture_class.empty());
}

TEST_F(Worlds, ImageRowsRunDownward) {
  std::string pixels = room_pixels(60, 50);
  pixels[12 * 60 + 30] = 0;  // near the top
  const World world = load_world(write("m.pgm", pgm(60, 50, pixels)), [] {
    WorldOptions options;
    options.pixel_size = 0.1;
    return options;
  }());
  EXPECT_EQ(world.voxels.state(30, 37, 0), CellState::kOccupied);
  EXPECT_EQ(world.voxels.state(30, 12, 0), CellState::kFree);
}

TEST_F(Worlds, FineMapsAreMergedConservatively) {
  std::string pixels = room_pixels(61, 51);
  pixels[25 * 61 + 30] = 0;
  WorldOptions options;
  options.pixel_size = 0.05;
  const std::string file = write("m.pgm", pgm(61, 51, pixels));
  const World coarse = load_world(file, options);
  EXPECT_NEAR(coarse.voxels.resolution(), 0.1, 1e-12);
  EXPECT_EQ(coarse.voxels.frame().width, 31);
  EXPECT_EQ(coarse.voxels.state(15, 12, 3), CellState::kOccupied) << "one pixel of four";
  options.resolution = 0.0;
  const World fine = load_world(file, options);
  EXPECT_EQ(fine.voxels.frame().width, 61);
  const GridFrame& frame = coarse.voxels.frame();
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    bool any_occupied = false, all_free = true;
    for (int q = 0; q < 4; ++q) {
      const int i = 2 * c.i + q % 2, j = 2 * c.j + q / 2;
      if (i >= 61 || j >= 51) continue;
      any_occupied = any_occupied || fine.voxels.state(i, j, 0) == CellState::kOccupied;
      all_free = all_free && fine.voxels.state(i, j, 0) == CellState::kFree;
    }
    ASSERT_EQ(coarse.voxels.state(c.i, c.j, 0), any_occupied ? CellState::kOccupied
                                                : all_free   ? CellState::kFree
                                                             : CellState::kUnknown);
  }
}

TEST_F(Worlds, DrawnPlansOfAnyDepthAndChannelsAreTheSame) {
  const std::string pixels = room_pixels(80, 70, 255, 178);
  cv::Mat grey(70, 80, CV_8UC1);
  std::copy(pixels.begin(), pixels.end(), reinterpret_cast<char*>(grey.data));
  const cv::Mat opaque(70, 80, CV_8UC1, cv::Scalar(255));
  cv::Mat colour, alpha, deep;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
  cv::merge(std::vector<cv::Mat>{grey, grey, grey, opaque}, alpha);
  grey.convertTo(deep, CV_16U, 257.0);
  std::vector<World> worlds;
  int n = 0;
  for (const cv::Mat& image : {grey, colour, alpha, deep}) {
    const std::string file = path("plan" + std::to_string(n++) + ".png");
    test::write_image(file, image);
    worlds.push_back(load_world(file));
    expect_sound(worlds.back());
    EXPECT_EQ(worlds.back().voxels.data(), worlds.front().voxels.data());
  }
  EXPECT_GT(count(worlds[0], 0, CellState::kUnknown), 0) << "178 fills a good part: unknown";
  // A fully transparent pixel is unknown whatever its colour.
  cv::Mat half = alpha.clone();
  for (int y = 20; y < 30; ++y) {
    for (int x = 20; x < 30; ++x) half.ptr(y)[4 * x + 3] = 0;
  }
  test::write_image(path("half.png"), half);
  EXPECT_EQ(count(load_world(path("half.png")), 0, CellState::kFree),
            count(worlds[0], 0, CellState::kFree) - 25);
}

TEST_F(Worlds, ImagesOfWrongSizeOrBrokenAreRefused) {
  const std::string good = pgm(60, 50, room_pixels(60, 50));
  EXPECT_THAT(refusal(write("short.pgm", good.substr(0, good.size() - 7))),
              HasSubstr("2993 bytes of pixels; expected 3000 for 60 x 50"));
  EXPECT_THAT(refusal(write("long.pgm", good + "x")), HasSubstr("3001 bytes of pixels"));
  EXPECT_THAT(refusal(write("zero.pgm", pgm(0, 50, ""))), HasSubstr("0 x 50"));
  EXPECT_THAT(refusal(write("huge.pgm", pgm(2000000000, 2000000000, ""))), HasSubstr("at most"));
  EXPECT_THAT(refusal(write("deep.pgm", "P5 2 2 65536\n12345678")), HasSubstr("largest value"));
  EXPECT_THAT(refusal(write("text.pgm", "P2 2 1 255 0")), HasSubstr("corrupt PGM"));
  EXPECT_THAT(refusal(write("text.pgm", "P2 1 1 255 256")), HasSubstr("the value 256"));
  EXPECT_THAT(refusal(write("text.pgm", "P2 1 1 255 0 0")), HasSubstr("follow the last pixel"));
  EXPECT_THAT(refusal(write("text.pgm", "P2 9999 9999 255 0")), HasSubstr("truncated"));
  EXPECT_THAT(refusal(write("ff.png", std::string(5000, '\xff'))), HasSubstr("PNG"));
  EXPECT_THAT(refusal(write("photo.png", "\xff\xd8\xff\xe0 and so on")), HasSubstr("JPEG"));
  cv::Mat image(50, 60, CV_8UC1, cv::Scalar(255));
  const std::vector<std::uint8_t> png = encode_pixels(".png", image);
  const std::string bytes(png.begin(), png.end());
  EXPECT_THAT(refusal(write("cut.png", bytes.substr(0, bytes.size() - 20))),
              HasSubstr("truncated"));
  EXPECT_THAT(refusal(write("black.pgm", pgm(60, 50, std::string(3000, '\0')))),
              HasSubstr("no free cell"));
}

TEST_F(Worlds, ImagesOfOtherKindsAreNamed) {
  const std::pair<std::string, const char*> kinds[] = {
      {"\xff\xd8\xff\xe0", "JPEG"},
      {"II*\n", "TIFF"},
      {"GIF89a", "GIF"},
      {"RIFF1234WEBP", "WebP"},
      {"<svg/>", "SVG"},
      {"version https://git-lfs.github.com/spec/v1", "Git LFS"},
      {"pixels", "no image"}};
  for (const auto& [begin, kind] : kinds) {
    EXPECT_THAT(refusal(write("a.png", begin + std::string(30, ' '))), HasSubstr(kind));
  }
}

TEST_F(Worlds, APngHasAllItsPixels) {
  // The height in the header is twice that of the pixels: the decoder fills in what is missing.
  const std::vector<std::uint8_t> bytes =
      encode_pixels(".png", cv::Mat(50, 60, CV_8UC1, cv::Scalar(254)));
  std::string png(bytes.begin(), bytes.end());
  EXPECT_NO_THROW(load_world(write("a.png", png)));
  png[23] = 100;
  std::uint32_t crc = static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const unsigned char*>(png.data()) + 12, 17));
  for (std::size_t n = 0; n < 4; ++n) png[32 - n] = static_cast<char>(crc >> (8 * n));
  EXPECT_THAT(refusal(write("a.png", png)),
              HasSubstr("3050 bytes of pixels in the PNG; expected 6100"));
}

TEST_F(Worlds, MutatedImagesAreRefusedOrSound) {
  cv::Mat image(40, 40, CV_8UC1, cv::Scalar(255));
  const std::vector<std::uint8_t> png = encode_pixels(".png", image);
  const std::string sources[] = {pgm(40, 40, std::string(1600, '\xff')),
                                 std::string(png.begin(), png.end())};
  std::mt19937_64 random(5);
  int accepted = 0;
  for (int n = 0; n < 300; ++n) {
    std::string bytes = sources[n % 2];
    const std::size_t header = std::min<std::size_t>(bytes.size(), 60);
    for (std::uint64_t e = 0; e <= random() % 3; ++e) {
      bytes[random() % header] = static_cast<char>(random() & 0xff);
    }
    if (n % 5 == 0) bytes.resize(random() % bytes.size());
    const std::string file = write(n % 2 ? "m.png" : "m.pgm", bytes);
    try {
      expect_sound(load_world(file));
      ++accepted;
    } catch (const InputError& e) {
      ASSERT_EQ(e.lines().size(), 1u);
    }
  }
  EXPECT_LT(accepted, 300);
}

TEST_F(Worlds, RosYamlIsStrict) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string good = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
  EXPECT_NO_THROW(load_world(write("m.yaml", good)));
  EXPECT_THAT(refusal(write("m.yaml", good + "occupied_tresh: 0.6\n")),
              HasSubstr("(did you mean 'occupied_thresh'?)"));
  EXPECT_THAT(refusal(write("m.yaml", "image: map.pgm\nresolution: 0\norigin: [0, 0, 0]\n")),
              HasSubstr("m.yaml:2: resolution"));
  EXPECT_THAT(refusal(write("m.yaml", "image: map.pgm\nresolution: 0.1\n")),
              HasSubstr("origin: missing"));
  EXPECT_THAT(refusal(write("m.yaml", good + "mode: row\n")), HasSubstr("trinary, scale, raw"));
  EXPECT_THAT(refusal(write("m.yaml", good + "mode: raw\nnegate: 1\n")),
              HasSubstr("m.yaml:5: negate"));
  EXPECT_THAT(refusal(write("m.yaml", good + "negate: maybe\n")),
              HasSubstr("expected 0, 1, true or false"));
}

/// As RosMapIsExtruded, in other words.
constexpr const char* kThresholds = "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

TEST_F(Worlds, RosYamlInAnySpelling) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string plain =
      std::string("image: map.pgm\nresolution: 0.1\norigin: [-1, 2, 0.0]\nnegate: 0\n") +
      kThresholds;
  const World expected = load_world(write("m.yaml", plain));
  const std::string spellings[] = {
      "{image: map.pgm, resolution: 0.1, origin: [-1, 2, 0], negate: 0, occupied_thresh: 0.65, "
      "free_thresh: 0.196}\n",
      "{\"image\": \"map.pgm\", \"resolution\": 0.1, \"origin\": [-1, 2, 0], \"negate\": false}",
      "\"image\": \"map.pgm\"\n'resolution': 0.1\n\"origin\": [-1, 2, 0]\n",
      "\xef\xbb\xbf" + plain,
      "---\n" + plain + "...\n",
      "image: map.pgm\r\nresolution: 0.1\r\norigin: [-1, 2, 0]\r\n",
      "image: 'map.pgm'\nresolution: '0.1'\norigin: ['-1', \"+2\", 0]\nnegate: 'false'\n",
      "image: map.pgm\nresolution: 1e-1\norigin:\n  - -1.0\n  - +2\n  - 0.\nnegate: no\n",
      "image: ./map.pgm\nresolution: .1\norigin: [-1, 2, 0]\nnegate: False\nmode: Trinary\n",
      "image: .\\map.pgm\nresolution: 0.1 # m\norigin: [-1, 2, 0]\nmode: SCALE\n"};
  for (const std::string& text : spellings) {
    const World world = load_world(write("m.yaml", text));
    EXPECT_EQ(world.voxels.data(), expected.voxels.data()) << text;
    EXPECT_TRUE(world.left_out.empty()) << text;
  }
}

TEST_F(Worlds, RosMapsWithOriginsInUtm) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const World world = load_world(
      write("m.yaml", "image: map.pgm\nresolution: 0.05\norigin: [448262.75, 5411932.25, 0]\n"));
  EXPECT_EQ(world.voxels.frame().j0, 0);
  EXPECT_EQ(world.left_out.text(),
            "the origin (448262.75, 5411932.25) m: positions count from the map's lower left "
            "corner");
  expect_sound(world);
  EXPECT_THAT(refusal(write("m.yaml", "image: map.pgm\nresolution: 0.05\norigin: [0, 1e8, 0]\n")),
              HasSubstr("m.yaml:3: origin"));
}

// As Cartographer writes probabilities: free space has greys on both sides of free_thresh.
TEST_F(Worlds, RosMapOfProbabilitiesNamesTheOptionThatHelps) {
  std::string pixels = room_pixels(60, 50);
  for (std::size_t n = 0; n < pixels.size(); n += 3) {
    if (static_cast<unsigned char>(pixels[n]) > 250) pixels[n] = static_cast<char>(196);
  }
  write("map.pgm", pgm(60, 50, pixels));
  const std::string yaml =
      std::string("image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n") + kThresholds;
  const std::string path = write("m.yaml", yaml);
  EXPECT_THAT(refusal(path), HasSubstr("no place where the robot can stand"));
  EXPECT_THAT(refusal(path), HasSubstr("a higher free_thresh in the .yaml, or --unknown free"));
  WorldOptions options;
  options.unknown_is_free = true;
  expect_sound(load_world(path, options));
  expect_sound(load_world(
      write("n.yaml", "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nfree_thresh: 0.3\n")));
}

TEST_F(Worlds, RosMapThatIsTooLargeNamesTheResolutionThatHelps) {
  write("map.pgm", pgm(1000, 100, room_pixels(1000, 100)));
  const std::string path = write("m.yaml", "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
  WorldOptions options;
  options.wall_height = 500.0;
  EXPECT_THAT(refusal(path, options), HasSubstr("--resolution 0.2 makes fewer"));
  options.voxel_size = 0.2;  // --resolution
  EXPECT_EQ(load_world(path, options).voxels.resolution(), 0.2);
}

TEST_F(Worlds, RosYamlWithoutItsImageIsAMapAllTheSame) {
  for (const char* rest : {"occupied_thresh: 0.65\n", "free_thresh: 0.2\n", ""}) {
    const std::string text = std::string("resolution: 0.1\norigin: [0, 0, 0]\n") + rest;
    EXPECT_THAT(refusal(write("m.yaml", text)), HasSubstr("image: missing"));
  }
}

TEST_F(Worlds, RosYamlMayHoldMore) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string plain = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
  for (const std::string key :
       {"map_type: occupancy", "cost_translation_table: {a: [1, 2]}", "name: ground floor"}) {
    EXPECT_EQ(load_world(write("m.yaml", plain + key + "\n")).left_out.text(),
              "key '" + key.substr(0, key.find(':')) + "'");
  }
}

TEST_F(Worlds, WhatIsLeftOutIsOneLineHoweverMuch) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  std::string yaml = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
  for (int n = 0; n < 50000; ++n) yaml += "their_key_" + std::to_string(n) + ": 1\n";
  const std::string text = load_world(write("m.yaml", yaml)).left_out.text();
  EXPECT_LT(text.size(), 1000u);
  EXPECT_THAT(text, HasSubstr("key 'their_key_11' and "));
  LeftOut all, more;
  all.count("sun");
  all.name("key 'a'");
  more.count("sun", 2);
  more.name("key 'a'");
  more.name("key 'b'");
  all.add(more);
  EXPECT_EQ(all.text(), "3 suns, key 'a', key 'b'");
}

TEST_F(Worlds, RosMapsInEveryFormatAndMode) {
  const std::string pixels = room_pixels(60, 50);
  const auto yaml = [&](const std::string& image, const std::string& more = "") {
    return write("m.yaml",
                 "image: " + image + "\nresolution: 0.1\norigin: [0, 0, 0]\n" + kThresholds + more);
  };
  write("map.pgm", pgm(60, 50, pixels));
  const World expected = load_world(yaml("map.pgm"));
  const auto same = [&](const std::string& file, const std::string& what) {
    EXPECT_EQ(load_world(file).voxels.data(), expected.voxels.data()) << what;
  };
  const auto each = [&](auto write_pixel) {
    std::string out;
    for (const char c : pixels) out += write_pixel(static_cast<unsigned char>(c));
    return out;
  };
  const std::string size = "\n60 50\n";
  write("a.pgm", "P2\n# CREATOR: an editor" + size + "255\n" +
                     each([](int v) { return std::to_string(v) + "\n"; }));
  write("b.pgm",
        "P5" + size + "65535\n" + each([](int v) { return std::string(2, static_cast<char>(v)); }));
  write("c.pgm", "P2" + size + "510\n" + each([](int v) { return std::to_string(2 * v) + " "; }));
  write("d.ppm",
        "P6" + size + "255\n" + each([](int v) { return std::string(3, static_cast<char>(v)); }));
  write("e.pgm", "P5\r\n60 50\r\n255\r\n" + pixels);
  for (const char* name : {"a.pgm", "b.pgm", "c.pgm", "d.ppm", "e.pgm"}) same(yaml(name), name);
  cv::Mat grey(50, 60, CV_8UC1);
  std::copy(pixels.begin(), pixels.end(), reinterpret_cast<char*>(grey.data));
  cv::Mat colour, padded, deep;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
  cv::merge(std::vector<cv::Mat>{grey, grey, grey, cv::Mat(50, 60, CV_8UC1, cv::Scalar(0))},
            padded);
  grey.convertTo(deep, CV_16U, 257.0);
  const std::pair<const char*, const cv::Mat*> images[] = {
      {"f.bmp", &grey}, {"g.bmp", &colour}, {"h.bmp", &padded}, {"i.png", &deep}};
  for (const auto& [name, image] : images) {
    test::write_image(path(name), *image);
    same(yaml(name), name);
  }
  // Black and white only: a set bit is black.
  std::string bits;
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 64; x += 8) {
      int byte = 0;
      for (int b = 0; b < 8; ++b) {
        byte |= (x + b < 60 && y > 4 && y < 45 && x + b > 4 && x + b < 55 ? 0 : 1) << (7 - b);
      }
      bits += static_cast<char>(byte);
    }
  }
  write("j.pbm", "P4" + size + bits);
  EXPECT_EQ(count(load_world(yaml("j.pbm")), 0, CellState::kFree), 40 * 50);

  // negate, and the modes.
  write("n.pgm", pgm(60, 50, each([](int v) {
                       return std::string(1, static_cast<char>(v == 205 ? 128 : 255 - v));
                     })));
  for (const char* negate : {"1", "true", "True", "yes"}) {
    same(yaml("n.pgm", "negate: " + std::string(negate) + "\n"), negate);
  }
  write("r.pgm", pgm(60, 50, each([](int v) {
                       return std::string(1, static_cast<char>(v == 205 ? 255 : v == 0 ? 100 : 0));
                     })));
  same(yaml("r.pgm", "mode: raw\n"), "raw");
  same(yaml("map.pgm", "mode: scale\n"), "scale");
}

TEST_F(Worlds, BrokenBmpIsRefused) {
  cv::Mat image(50, 60, CV_8UC3, cv::Scalar(255, 255, 255));
  const std::vector<std::uint8_t> bmp = encode_pixels(".bmp", image);
  const std::string bytes(bmp.begin(), bmp.end());
  const auto with = [&](std::size_t at, const std::string& word) {
    std::string text = bytes;
    text.replace(at, word.size(), word);
    return write("x.bmp", text);
  };
  EXPECT_NO_THROW(load_world(write("x.bmp", bytes)));
  EXPECT_THAT(refusal(write("x.bmp", bytes.substr(0, 40))), HasSubstr("truncated BMP"));
  EXPECT_THAT(refusal(write("x.bmp", bytes.substr(0, bytes.size() - 1))), HasSubstr("truncated"));
  EXPECT_THAT(refusal(with(18, std::string("\xff\xff\xff\x7f"))), HasSubstr("at most"));
  EXPECT_THAT(refusal(with(22, std::string("\0\0\0\x80", 4))), HasSubstr("at most"));
  EXPECT_THAT(refusal(with(30, std::string("\1"))), HasSubstr("compressed BMP"));
  EXPECT_THAT(refusal(with(28, std::string("\0\0", 2))), HasSubstr("0 bits"));
}

TEST_F(Worlds, RotatedMapsAreTurned) {
  // Not symmetric: a pillar near one corner.
  std::string pixels = room_pixels(60, 50);
  for (int n = 0; n < 9; ++n) pixels[static_cast<std::size_t>((38 + n / 3) * 60 + 10 + n % 3)] = 0;
  write("map.pgm", pgm(60, 50, pixels));
  const auto turned = [&](const std::string& yaw) {
    return load_world(
        write("m.yaml", "image: map.pgm\nresolution: 0.1\norigin: [1, 2, " + yaw + "]\n"));
  };
  const World straight = turned("0");
  const GridFrame& frame = straight.voxels.frame();
  EXPECT_THAT(refusal(write("m.yaml", "image: map.pgm\nresolution: 0.1\norigin: [1, 2, 90]\n")),
              HasSubstr("m.yaml:3: origin: has a yaw of more than 8 rad; expected radians"));
  for (const double yaw : {M_PI / 2, -M_PI / 2, M_PI, 0.5, -2.0, 7.0}) {
    const World world = turned(std::to_string(yaw));
    expect_sound(world);
    int wrong = 0, known = 0;
    for (int n = 0; n < frame.size(); ++n) {
      const Eigen::Vector2d p = frame.center(frame.at(n)) - Eigen::Vector2d(1, 2);
      const Eigen::Vector2d q = Eigen::Vector2d(1, 2) + Eigen::Rotation2Dd(yaw) * p;
      const Cell to = world.voxels.frame().cell(q.x(), q.y());
      const CellState state = straight.voxels.state(frame.at(n).i, frame.at(n).j, 0);
      known += state != CellState::kUnknown;
      wrong += world.voxels.state(to.i, to.j, 0) != state;
      // A wall never becomes free.
      if (state == CellState::kOccupied) {
        EXPECT_NE(world.voxels.state(to.i, to.j, 0), CellState::kFree);
      }
    }
    const bool right = std::abs(std::remainder(yaw, M_PI / 2)) < 1e-6;
    EXPECT_LE(wrong, right ? 0 : known / 8) << yaw;
  }
}

TEST_F(Worlds, UnknownSpaceCountsAsFreeIfThatIsAskedFor) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string yaml = write("m.yaml", "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
  WorldOptions options;
  options.unknown_is_free = true;
  const World world = load_world(yaml, options);
  EXPECT_EQ(count(world, 0, CellState::kUnknown), 0);
  EXPECT_EQ(count(world, 0, CellState::kOccupied), 50 * 40 - 46 * 36);
  // An octree of surfaces alone.
  octomap::OcTree tree(0.1);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      for (int k = 0; k < 15; ++k) {
        const bool wall = i == 0 || j == 0 || i == 39 || j == 39;
        if (wall || k == 0) {
          tree.setNodeValue(octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + i),
                                               static_cast<octomap::key_type>(32768 + j),
                                               static_cast<octomap::key_type>(32768 + k)),
                            3.5f);
        }
      }
    }
  }
  write_octree(tree, path("shell.bt"));
  EXPECT_THAT(refusal(path("shell.bt")), HasSubstr("--unknown free"));
  const World shell = load_world(path("shell.bt"), options);
  EXPECT_NEAR(shell.source_floor_height, 0.1, 1e-9);
  EXPECT_EQ(count(shell, 0, CellState::kFree), 38 * 38);
}

TEST_F(Worlds, OptionsThatSayNothingOfASourceAreRefused) {
  write("map.pgm", pgm(60, 50, room_pixels(60, 50)));
  const std::string yaml = write("m.yaml", "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
  WorldOptions options;
  options.floor = 1.0;
  EXPECT_THAT(refusal(yaml, options), HasSubstr("--floor"));
  EXPECT_THAT(refusal("office", options), HasSubstr("--floor"));
  options = {};
  options.voxel_size = 0.2;
  EXPECT_DOUBLE_EQ(load_world(yaml, options).voxels.resolution(), 0.2);
  EXPECT_DOUBLE_EQ(load_world(path("map.pgm"), options).voxels.resolution(), 0.2);
  EXPECT_THAT(refusal("office", options), HasSubstr("--resolution"));
  EXPECT_THAT(refusal("plan:3", options), HasSubstr("--resolution"));
  options.voxel_size = 0.05;
  EXPECT_THAT(refusal(yaml, options), HasSubstr("cells of 0.1 m"));
  options = {};
  options.ground_margin = 1.0;
  EXPECT_THAT(refusal(yaml, options), HasSubstr("--ground"));
}

TEST_F(Worlds, WhatIsNoFileEndsAtOnce) {
  for (const char* name : {"f.yaml", "f.bt", "f.pgm", "f.map", "f.obj", "f.world", "f.glb"}) {
    ASSERT_EQ(::mkfifo(path(name).c_str(), 0600), 0);
    EXPECT_THAT(refusal(path(name)), HasSubstr("is not a regular file"));
    fs::remove(path(name));
    fs::create_symlink("/dev/zero", path(name));
    EXPECT_THAT(refusal(path(name)), HasSubstr("is not a regular file"));
  }
}

TEST_F(Worlds, WhatMayNotBeReadIsSaid) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  for (const char* name : {"f.yaml", "f.bt", "f.pgm", "f.map", "f.obj", "f.world", "f.glb"}) {
    write(name, "content");
    fs::permissions(path(name), fs::perms::none);
    EXPECT_THAT(refusal(path(name)), HasSubstr("cannot be read; expected"));
  }
}

TEST_F(Worlds, AnAbsentImageIsNotReplacedByAnotherOne) {
  const std::string text = "image: other.png\nresolution: 0.1\norigin: [0, 0, 0]\n";
  const std::string yaml = write("map.yaml", text);
  EXPECT_THAT(refusal(yaml), HasSubstr("map.yaml:1: image 'other.png' is absent"));
  for (const char* name : {"a.pgm", "map.pgm", "other.pgm", "b.bmp"}) {
    write(name, pgm(60, 50, room_pixels(60, 50)));
    EXPECT_THAT(refusal(yaml), HasSubstr("is absent"));
    EXPECT_THAT(refusal(yaml), HasSubstr("'" + std::string(name) + "'"));
  }
  EXPECT_THAT(refusal(write("c.yaml",
                            "image: \"a\\x1b[2J\\n.png\"\nresolution: 0.1\norigin: [0, 0, "
                            "0]\n")),
              ::testing::Not(::testing::AnyOf(HasSubstr("\x1b"), HasSubstr("\n"))));
  // The same one, of a folder that was moved, and that is told.
  const World moved = load_world(
      write("moved.yaml", "image: /home/them/maps/a.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n"));
  EXPECT_EQ(moved.voxels.frame().width, 60);
  EXPECT_THAT(moved.left_out.text(), HasSubstr("'/home/them/maps/a.pgm' (absent"));
  EXPECT_THAT(load_world(write("moved.yaml",
                               "image: C:\\maps\\a.pgm\nresolution: 0.1\norigin: "
                               "[0, 0, 0]\n"))
                  .left_out.text(),
              HasSubstr("'C:\\maps\\a.pgm' (absent"));
}

TEST_F(Worlds, MovingAiGridsAreRead) {
  std::string rows;
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < 40; ++i)
      rows += i < 2 || j < 2 || i > 37 || j > 27 ? '@' : j == 5 && i < 20 ? 'T' : '.';
    rows += '\n';
  }
  const std::string head = "type octile\nheight 30\nwidth 40\nmap\n";
  WorldOptions options;
  options.pixel_size = 0.1;
  const World world = load_world(write("m.map", head + rows), options);
  expect_sound(world);
  EXPECT_EQ(world.voxels.state(10, 24, 0), CellState::kOccupied);
  EXPECT_EQ(world.voxels.state(30, 24, 0), CellState::kFree);
  EXPECT_THAT(refusal(write("m.map", head + rows.substr(41))), HasSubstr("29 rows; expected 30"));
  EXPECT_THAT(refusal(write("m.map", head + "x" + rows.substr(1))),
              HasSubstr("m.map:5: a cell of unknown kind"));
  EXPECT_THAT(refusal(write("m.map", head + rows.substr(1))), HasSubstr("m.map:5: 39 cells"));
  EXPECT_THAT(refusal(write("m.map", "type octile\nheight -3\nwidth 40\nmap\n")), HasSubstr("-3"));
  EXPECT_THAT(refusal(write("m.map", "hello\n")), HasSubstr("not a MovingAI grid"));
}

// --- octrees
// ---------------------------------------------------------------------------------------

void put(octomap::OcTree& tree, int i, int j, int k, bool occupied) {
  tree.setNodeValue(octomap::OcTreeKey(static_cast<octomap::key_type>(32768 + i),
                                       static_cast<octomap::key_type>(32768 + j),
                                       static_cast<octomap::key_type>(32768 + k)),
                    occupied ? 3.5f : -2.0f);
}

/// A room with its floor's surface at z = -0.2 m; voxels that `known` refuses are left out.
octomap::OcTree octree_room(
    bool with_floor,
    const std::function<bool(int, int, int)>& known = [](int, int, int) { return true; }) {
  octomap::OcTree tree(0.1);
  for (int i = -15; i < 25; ++i) {
    for (int j = -10; j < 20; ++j) {
      const bool wall = i == -15 || i == 24 || j == -10 || j == 19;
      if (with_floor) put(tree, i, j, -3, true);
      for (int k = -2; k < 20; ++k) {
        if (known(i, j, k)) put(tree, i, j, k, wall || (k == 5 && i > 20));
      }
    }
  }
  return tree;
}

TEST_F(Worlds, OctreeFloorComesToZero) {
  for (const bool with_floor : {true, false}) {
    octomap::OcTree tree = octree_room(with_floor);
    tree.toMaxLikelihood();
    tree.prune();
    const std::string file = path("room.bt");
    write_octree(tree, file);
    const World world = load_world(file);
    expect_sound(world);
    EXPECT_NEAR(world.source_floor_height, -0.2, 1e-9);
    EXPECT_EQ(world.voxels.state(0, 0, -1), CellState::kOccupied);
    EXPECT_EQ(world.voxels.state(0, 0, 0), CellState::kFree);
    EXPECT_EQ(world.voxels.state(22, 0, 7), CellState::kOccupied) << "the table, moved by 2 voxels";
    EXPECT_EQ(world.voxels.state(22, 0, 6), CellState::kFree);
    EXPECT_EQ(count(world, 3, CellState::kFree), 38 * 28);
    EXPECT_NEAR(world.start.position.x(), 0.5, 0.6);
  }
}

TEST_F(Worlds, OctreePocketsOfTheSensorAreFreeOthersStayUnknown) {
  const octomap::OcTree tree = octree_room(true, [](int i, int j, int k) {
    const auto block = [&](int i0, int k0) {
      return i >= i0 && i < i0 + 3 && j >= 0 && j < 3 && k >= k0 && k < k0 + 2;
    };
    // Amid free space; under the table; at the border of what is known.
    return !block(0, 3) && !block(21, 3) && !block(8, 18);
  });
  const World world = world_from_octree(tree, "room");
  EXPECT_EQ(world.voxels.state(1, 1, 5), CellState::kFree);
  EXPECT_EQ(world.voxels.state(22, 1, 5), CellState::kUnknown);
  EXPECT_EQ(world.voxels.state(9, 1, 21), CellState::kUnknown);
  OctreeWorldOptions options;
  options.max_pocket = 0.01;
  EXPECT_EQ(world_from_octree(tree, "room", options).voxels.state(1, 1, 5), CellState::kUnknown);
}

TEST_F(Worlds, OctreeWithoutFreeSpaceOrTooLargeIsRefused) {
  octomap::OcTree tree(0.1);
  EXPECT_THROW(world_from_octree(tree, "x"), InputError);
  put(tree, 0, 0, 0, true);
  EXPECT_THROW(world_from_octree(tree, "x"), InputError);
  put(tree, 1, 0, 0, false);
  EXPECT_NO_THROW(world_from_octree(tree, "x"));
  // A ray of free voxels that ties two places together.
  for (int i = 0; i < 30000; ++i) {
    put(tree, i, i, i / 10, false);
    put(tree, i, i + 1, i / 10, false);
  }
  EXPECT_THROW(world_from_octree(tree, "x"), InputError);
}

TEST_F(Worlds, StrayVoxelsAreLeftOutAndTold) {
  const World plain = [&] {
    write_octree(octree_room(true), path("room.bt"));
    return load_world(path("room.bt"));
  }();
  struct Case {
    const char* what;
    std::vector<std::array<int, 4>> voxels;  // and whether occupied
    const char* told;
  };
  const Case cases[] = {{"one, far off", {{20000, 20000, 5, 1}}, "1 voxel up to 28"},
                        {"one 500 m off", {{5000, 0, 5, 1}}, "1 voxel up to 498 m off"},
                        {"one above", {{0, 0, 6000, 1}}, "1 voxel up to 59"},
                        {"one below", {{0, 0, -900, 1}}, "1 voxel up to 89"},
                        {"a free one", {{-3000, 0, 0, 0}}, "1 voxel up to 29"},
                        {"several, all around",
                         {{4000, 0, 0, 1}, {4001, 0, 0, 0}, {0, -4000, 0, 1}, {0, 0, 800, 1}},
                         "4 voxels up to"}};
  for (const Case& c : cases) {
    octomap::OcTree tree = octree_room(true);
    for (const auto& [i, j, k, occupied] : c.voxels) put(tree, i, j, k, occupied != 0);
    write_octree(tree, path("stray.bt"));
    const World world = load_world(path("stray.bt"));
    EXPECT_EQ(world.voxels.data(), plain.voxels.data()) << c.what;
    EXPECT_NEAR(world.source_floor_height, plain.source_floor_height, 1e-9) << c.what;
    EXPECT_THAT(world.left_out.text(), HasSubstr(c.told));
  }
  EXPECT_TRUE(plain.left_out.empty());
  EXPECT_GT(plain.floor_share, 0.7);
  // One with the ray that leads there.
  octomap::OcTree tree = octree_room(true);
  for (int i = 10; i < 6000; ++i) put(tree, i, i / 2, i / 20, false);
  put(tree, 6000, 3000, 300, true);
  write_octree(tree, path("ray.bt"));
  const World world = load_world(path("ray.bt"));
  EXPECT_LT(world.voxels.frame().size(), 40'000);
  EXPECT_THAT(world.left_out.text(), HasSubstr("which thin rays connect"));
  EXPECT_NEAR(describe(world, {}).standing_area, describe(plain, {}).standing_area, 0.5);
}

TEST_F(Worlds, OctreeOfSeveralStoreys) {
  octomap::OcTree tree(0.1);
  for (const int storey : {0, 30}) {
    for (int i = 0; i < 50; ++i) {
      for (int j = 0; j < 40; ++j) {
        const bool wall = i == 0 || j == 0 || i == 49 || j == 39 || (storey > 0 && i == 20);
        put(tree, i, j, storey, true);
        for (int k = 1; k < 25; ++k) put(tree, i, j, storey + k, wall);
      }
    }
  }
  write_octree(tree, path("two.bt"));
  WorldOptions options;
  options.floor = 3.2;
  const World high = load_world(path("two.bt"), options);
  EXPECT_NEAR(high.source_floor_height, 3.1, 1e-9);
  EXPECT_NEAR(high.floor_share, 0.5, 0.1);
  EXPECT_EQ(high.voxels.state(20, 10, 3), CellState::kOccupied);
  options.floor = 0.0;
  const World low = load_world(path("two.bt"), options);
  EXPECT_NEAR(low.source_floor_height, 0.1, 1e-9);
  EXPECT_EQ(low.voxels.state(20, 10, 3), CellState::kFree);
  options.floor = 1.7;
  EXPECT_THAT(refusal(path("two.bt"), options), HasSubstr("expected one of the heights 0.1, 3.1"));
}

TEST_F(Worlds, OctreeWhoseGroundIsNotFlatIsRefused) {
  const auto with = [&](auto height) {
    octomap::OcTree tree(0.1);
    for (int i = 0; i < 80; ++i) {
      for (int j = 0; j < 60; ++j) {
        const int floor = height(i, j);
        put(tree, i, j, floor, true);
        for (int k = floor + 1; k < floor + 15; ++k) put(tree, i, j, k, false);
      }
    }
    write_octree(tree, path("hill.bt"));
    return path("hill.bt");
  };
  const auto ramp = [](int i, int) { return i / 4; };
  EXPECT_THAT(refusal(with(ramp)), HasSubstr("the ground is not flat"));
  EXPECT_THAT(refusal(with([](int i, int j) { return (i + j) / 6; })), HasSubstr("not flat"));
  WorldOptions options;
  options.floor = 1.0;
  EXPECT_LT(load_world(with(ramp), options).floor_share, 0.25);
  // A ramp beside a floor, and a floor that tilts a little.
  EXPECT_GT(load_world(with([](int i, int) { return std::max(0, i - 60) / 4; })).floor_share, 0.6);
  EXPECT_NO_THROW(load_world(with([](int i, int) { return i / 20; })));
}

/// Random voxels above a floor, about half of them unknown in places; addresses on both sides of 0.
octomap::OcTree mottled_octree(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  octomap::OcTree tree(0.05);
  for (int i = -31; i < 30; ++i) {
    for (int j = -23; j < 28; ++j) {
      put(tree, i, j, -6, true);
      for (int k = -5; k < 32; ++k) {
        const int known = i < 0 ? 50 : 95;
        const int occupied = (i / 8 + j / 8) % 2 == 0 ? 0 : 4;
        if (static_cast<int>(random() % 100) >= known) continue;
        put(tree, i, j, k, static_cast<int>(random() % 100) < occupied);
      }
    }
  }
  return tree;
}

TEST_F(Worlds, FineOctreesAreMerged) {
  struct Count {
    int occupied = 0, free = 0, all = 0;
  };
  OctreeWorldOptions options;
  options.max_pocket = 0.0;
  for (const int factor : {2, 3, 5}) {
    SCOPED_TRACE(factor);
    const octomap::OcTree tree = mottled_octree(static_cast<std::uint64_t>(factor));
    options.resolution = 0.0;
    const World fine = world_from_octree(tree, "x", options);
    ASSERT_NEAR(fine.voxels.resolution(), 0.05, 1e-12);
    ASSERT_EQ(fine.voxels.state(0, 0, -1), CellState::kOccupied);
    options.resolution = 0.05 * factor + 0.02;
    const World coarse = world_from_octree(tree, "x", options);
    EXPECT_NEAR(coarse.voxels.resolution(), 0.05 * factor, 1e-12);
    EXPECT_EQ(coarse.source_floor_height, fine.source_floor_height);
    EXPECT_EQ(coarse.voxels.k0(), -1);

    // Every fine voxel above the floor belongs to the coarse one that contains its centre.
    std::map<std::array<int, 3>, Count> counts;
    const GridFrame f = fine.voxels.frame();
    const auto owner = [&](int n) { return static_cast<int>(std::floor((n + 0.5) / factor)); };
    for (int n = 0; n < f.size(); ++n) {
      const Cell c = f.at(n);
      for (int k = 0; k < fine.voxels.k0() + fine.voxels.depth(); ++k) {
        Count& count = counts[{owner(c.i), owner(c.j), owner(k)}];
        const CellState state = fine.voxels.state(c.i, c.j, k);
        count.occupied += state == CellState::kOccupied;
        count.free += state == CellState::kFree;
        ++count.all;
      }
    }
    const GridFrame g = coarse.voxels.frame();
    EXPECT_EQ(counts.size(), static_cast<std::size_t>(g.size() * (coarse.voxels.depth() - 1)));
    std::map<CellState, int> seen;
    int halves = 0;
    for (const auto& [at, count] : counts) {
      const CellState expected = count.occupied > 0            ? CellState::kOccupied
                                 : 2 * count.free >= count.all ? CellState::kFree
                                                               : CellState::kUnknown;
      ASSERT_EQ(coarse.voxels.state(at[0], at[1], at[2]), expected)
          << at[0] << " " << at[1] << " " << at[2];
      ++seen[expected];
      halves += count.occupied == 0 && 2 * count.free == count.all;
    }
    EXPECT_EQ(seen.size(), 3u);
    if (factor == 2) {
      EXPECT_GT(halves, 100) << "exactly half free is free";
    }
    // The floor is the layer just below z = 0, under free space.
    int floor = 0;
    for (int n = 0; n < g.size(); ++n) {
      const Cell c = g.at(n);
      const bool free = coarse.voxels.state(c.i, c.j, 0) == CellState::kFree;
      ASSERT_EQ(coarse.voxels.state(c.i, c.j, -1),
                free ? CellState::kOccupied : CellState::kUnknown);
      floor += free;
    }
    EXPECT_GT(floor, 20);
  }
}

TEST_F(Worlds, OctreesThatAreCoarseEnoughStayAsTheyAre) {
  const octomap::OcTree tree = mottled_octree(9);
  OctreeWorldOptions options;
  const World fine = world_from_octree(tree, "x", options);
  for (const double resolution : {0.01, 0.05, 0.099, -1.0}) {
    options.resolution = resolution;
    const World world = world_from_octree(tree, "x", options);
    EXPECT_EQ(world.voxels.resolution(), fine.voxels.resolution());
    EXPECT_EQ(world.voxels.data(), fine.voxels.data());
  }
  options.resolution = 0.1;
  EXPECT_NEAR(world_from_octree(tree, "x", options).voxels.resolution(), 0.1, 1e-12);
}

// --- texture
// ---------------------------------------------------------------------------------------

TEST_F(Worlds, PatchyTextureHasItsSharesAndPatches) {
  World world = load_world("office");
  world.texture_class.clear();
  double rich = 0, poor = 0, blank = 0, all = 0;
  double runs = 0, length = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (int j = -500; j < 500; j += 50) {
      double previous = -1.0;
      for (int i = -300; i < 300; ++i) {
        const double d = texture_density(world, i, j, 5, seed);
        rich += d == 40.0;
        poor += d == 2.0;
        blank += d == 0.0;
        ++all;
        runs += d != previous;
        length += 0.1;
        previous = d;
      }
    }
  }
  EXPECT_EQ(rich + poor + blank, all);
  EXPECT_NEAR(rich / all, 0.5, 0.03);
  EXPECT_NEAR(poor / all, 0.3, 0.03);
  EXPECT_NEAR(blank / all, 0.2, 0.03);
  EXPECT_GT(length / runs, 2.0) << "mean length of a patch along a line [m]";
  EXPECT_LT(length / runs, 5.0);
  EXPECT_EQ(texture_density(world, 3, 4, 5, 9), texture_density(world, 3, 4, 5, 9));
  EXPECT_TRUE(std::isfinite(texture_density(world, 2000000000, -2000000000, 0, 1)));
}

// --- real maps
// -------------------------------------------------------------------------------------

TEST_F(Worlds, RealMapsLoadAndCanBeExplored) {
  NOT_UNDER_SANITIZERS("real maps go the ways of small ones");
  const fs::path data = PROSPECT_SHARED_DATA;
  if (!fs::exists(data / "maps2d")) GTEST_SKIP() << "no shared data: " << data;
  int loaded = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    const std::string e = entry.path().extension().string();
    const std::string folder = entry.path().string();
    const bool map2d =
        folder.find("maps2d") != std::string::npos && (e == ".yaml" || e == ".png" || e == ".map");
    const bool octree = e == ".bt" && folder.find("dw_nav2") == std::string::npos &&
                        folder.find("fieldcases") == std::string::npos;
    if (!map2d && !octree) continue;
    SCOPED_TRACE(folder);
    if (folder.find("aws_warehouse/map.yaml") != std::string::npos) {
      EXPECT_THAT(refusal(folder), HasSubstr("image 'map_rotated.png' is absent"));
      continue;
    }
    const World world = load_world(folder);
    expect_sound(world);
    EXPECT_GT(describe(world, {}).standing_area, 20.0);
    ++loaded;
  }
  EXPECT_GE(loaded, 25);
  // A slab of half a metre about the floor: there is no room for a body.
  const std::string slab = (data / "octomap/dw_nav2/map.bt").string();
  if (fs::exists(slab)) {
    EXPECT_THAT(refusal(slab), HasSubstr("no place where the robot can stand"));
  }
}

}  // namespace
}  // namespace prospect::worlds_test
