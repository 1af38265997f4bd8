// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/reachable_area.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/world_file.h"
#include "adapters/robots/simulator/kinematic_robot.h"
#include "engine/maps/heading_fit.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::reachable_area_test {
namespace {

/// A world whose columns are free or solid over their whole height, with some obstacles in the
/// sight layer only and some below it only.
World random_world(std::uint64_t seed, double r, int width, int height, double solid) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const GridFrame frame{r, -static_cast<int>(seed % 7), 3 - static_cast<int>(seed % 11), width,
                        height};
  World world{"random", VoxelGrid(frame, -0.5 * r, 0.99), {}, {}, {}, 0.0};
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    const double kind = u(random);
    for (int k = -1; k < world.voxels.k0() + world.voxels.depth(); ++k) {
      const double z = (k + 0.5) * r;
      CellState state = CellState::kFree;
      if (k == -1 || kind < solid) state = CellState::kOccupied;
      if (k >= 0 && kind >= solid && kind < 1.5 * solid) state = CellState::kUnknown;
      if (kind >= 1.5 * solid && kind < 1.7 * solid && std::abs(z - 0.4) < 0.15) {
        state = CellState::kOccupied;
      }
      if (kind >= 1.7 * solid && kind < 1.8 * solid && z > 0.6) state = CellState::kOccupied;
      world.voxels.set(c.i, c.j, k, state);
    }
  }
  return world;
}

bool column_free(const World& world, Cell c, const BodySlice& slice) {
  const double r = world.voxels.resolution();
  for (int k = world.voxels.k0(); k < world.voxels.k0() + world.voxels.depth(); ++k) {
    const bool overlaps = (k + 1) * r > slice.z_min + 1e-9 && k * r < slice.z_max - 1e-9;
    if (overlaps && world.voxels.state(c.i, c.j, k) != CellState::kFree) return false;
  }
  return world.voxels.frame().contains(c);
}

/// Squared distance from a point to a column's square.
double clearance_to(const World& world, const Eigen::Vector2d& p, Cell c) {
  const double r = world.voxels.resolution();
  const Eigen::Vector2d low(c.i * r, c.j * r);
  const Eigen::Vector2d nearest = p.cwiseMax(low).cwiseMin(low + Eigen::Vector2d::Constant(r));
  return (p - nearest).norm();
}

TEST(StandingColumns, AgreeWithTheDistanceToEveryObstacle) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const World world = random_world(seed, seed % 2 ? 0.1 : 0.08, 34, 27, 0.02);
    BodySlice slice;
    slice.standing_clearance = seed % 3 == 0 ? 0.0 : 0.05 * static_cast<double>(seed);
    const Grid<std::uint8_t> standing = standing_columns(world.voxels, slice);
    const GridFrame& frame = standing.frame;
    for (int n = 0; n < frame.size(); ++n) {
      const Cell c = frame.at(n);
      double nearest = column_free(world, c, slice) ? 1e9 : -1.0;
      for (int j = frame.j0 - 12; j < frame.j0 + frame.height + 12; ++j) {
        for (int i = frame.i0 - 12; i < frame.i0 + frame.width + 12; ++i) {
          if (std::abs(i - c.i) > 9 || std::abs(j - c.j) > 9) continue;
          if (column_free(world, {i, j}, slice)) continue;
          nearest = std::min(nearest, clearance_to(world, frame.center(c), {i, j}));
        }
      }
      const bool expected =
          column_free(world, c, slice) && nearest > slice.standing_clearance - 1e-9;
      ASSERT_EQ(standing[c] != 0, expected) << "seed " << seed << " cell " << c.i << " " << c.j;
    }
  }
}

/// Whether the segment between two centres misses what is not free, by geometry over all columns of
/// the rectangle that the centres span. Coordinates in half cells, so that centres and corners are
/// whole numbers.
bool clear_line(const World& world, int layer, Cell a, Cell b) {
  const int ax = 2 * a.i + 1, ay = 2 * a.j + 1, dx = 2 * (b.i - a.i), dy = 2 * (b.j - a.j);
  const auto side = [&](int x, int y) { return (x - ax) * dy - (y - ay) * dx; };
  const auto solid = [&](int i, int j) {
    return world.voxels.state(i, j, layer) != CellState::kFree;
  };
  const int i0 = std::min(a.i, b.i), i1 = std::max(a.i, b.i);
  const int j0 = std::min(a.j, b.j), j1 = std::max(a.j, b.j);
  for (int i = i0; i <= i1; ++i) {
    for (int j = j0; j <= j1; ++j) {
      const int s[] = {side(2 * i, 2 * j), side(2 * i + 2, 2 * j), side(2 * i, 2 * j + 2),
                       side(2 * i + 2, 2 * j + 2)};
      const bool crossed = *std::min_element(s, s + 4) < 0 && *std::max_element(s, s + 4) > 0;
      if (crossed && solid(i, j)) return false;
      // The corner shared with (i + 1, j + 1): the two others there lie beside the line.
      if (i < i1 && j < j1 && s[3] == 0) {
        const bool rising = (dx > 0) == (dy > 0);
        if (rising ? solid(i + 1, j) && solid(i, j + 1) : solid(i, j) && solid(i + 1, j + 1)) {
          return false;
        }
      }
    }
  }
  return true;
}

/// The definition in the header, word for word.
Grid<std::uint8_t> by_definition(const World& world, const ReachableAreaOptions& options,
                                 const Grid<std::uint8_t>& standing, const GridFrame& cells) {
  const GridFrame& frame = world.voxels.frame();
  const double r = frame.resolution, m = options.map_resolution;
  const int layer = static_cast<int>(std::floor(options.sensor_height / r + 1e-9));
  const auto center = [&](Cell c) {
    return Eigen::Vector3d((c.i + 0.5) * r, (c.j + 0.5) * r, (layer + 0.5) * r);
  };
  Grid<std::uint8_t> out(cells, 0);
  for (int n = 0; n < cells.size(); ++n) {
    const Cell cell = cells.at(n);
    const Cell h{static_cast<int>(std::floor((cell.i + 0.5) * m / r + 1e-9)),
                 static_cast<int>(std::floor((cell.j + 0.5) * m / r + 1e-9))};
    bool all_free = frame.contains(h) && column_free(world, h, options.slice);
    for (int q = 0; q < frame.size(); ++q) {
      const Cell c = frame.at(q);
      const bool inside = std::floor((c.i + 0.5) * r / m + 1e-9) == cell.i &&
                          std::floor((c.j + 0.5) * r / m + 1e-9) == cell.j;
      if (inside && !column_free(world, c, options.slice)) all_free = false;
    }
    if (!all_free) continue;
    for (int q = 0; q < frame.size() && out[cell] == 0; ++q) {
      const Cell a = frame.at(q);
      if (standing[a] == 0) continue;
      if ((center(a) - center(h)).norm() > options.range + 1e-9) continue;
      if (a == h) {
        out[cell] = 1;
        continue;
      }
      if (world.voxels.state(a.i, a.j, layer) != CellState::kFree) continue;
      if (clear_line(world, layer, a, h)) out[cell] = 1;
    }
  }
  return out;
}

TEST(ReachableArea, AgreesWithItsDefinition) {
  int partly = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    World world = random_world(seed, seed % 2 ? 0.1 : 0.08, 40, 33, seed % 4 ? 0.06 : 0.2);
    ReachableAreaOptions options;
    options.slice.standing_clearance = 0.1;  // for what it is compared with
    options.slice.shape = CylinderShape{{0, 0, 0.3}, 0.08, 0.4};
    options.room = 0.02;
    options.range = 1.7;
    options.sensor_height = seed % 3 ? 0.4 : 0.55;
    options.slice.z_max = seed % 3 ? 0.5 : 0.6;
    const Grid<std::uint8_t> all = standing_columns(world.voxels, options.slice);
    for (int n = 0; n < all.frame.size(); ++n) {
      if (all.data[static_cast<std::size_t>(n)] == 0) continue;
      world.start.position.head<2>() = all.frame.center(all.frame.at(n));
      break;
    }
    const ReachableArea result = reachable_area(world, options);
    EXPECT_EQ(
        result.standing.data,
        connected_component(all, all.frame.cell(world.start.position.x(), world.start.position.y()))
            .data);
    EXPECT_EQ(result.too_long_for, 0.0) << "a round body";
    const Grid<std::uint8_t> expected =
        by_definition(world, options, result.standing, result.cells.frame);
    int count = 0, differ = 0, free = 0;
    for (std::size_t n = 0; n < expected.data.size(); ++n) {
      differ += expected.data[n] != result.cells.data[n];
      count += expected.data[n];
    }
    for (const std::uint8_t f : free_columns(world.voxels, options.slice).data) free += f;
    EXPECT_EQ(differ, 0) << "seed " << seed << ", " << count << " cells";
    EXPECT_GT(count, 0);
    EXPECT_NEAR(result.area, count * 0.01, 1e-9);
    const double r = world.voxels.resolution();
    partly += count * 0.01 < 0.9 * free * r * r;
  }
  EXPECT_GT(partly, 3) << "the worlds must also have places that cannot be seen";
}

/// Room, wall with a slit too narrow to pass, room beyond it.
World slit_world(bool slit) {
  const double r = 0.1;
  const GridFrame frame{r, 0, 0, 100, 40};
  World world{"slit", VoxelGrid(frame, -0.05, 0.95), {}, {}, {}, 0.0};
  for (int i = 1; i < 99; ++i) {
    for (int j = 1; j < 39; ++j) {
      world.voxels.set(i, j, -1, CellState::kOccupied);
      const bool wall = i == 40 && !(slit && j == 20);
      for (int k = 0; k < 10; ++k) {
        world.voxels.set(i, j, k, wall ? CellState::kOccupied : CellState::kFree);
      }
    }
  }
  world.start.position = {2.0, 2.0, 0.0};
  return world;
}

// With no room asked for, a body stands where the simulator finds it free of contact.
TEST(FittingHeadings, AgreeWithTheContactTest) {
  const RobotShape shapes[] = {BoxShape{{0.05, 0.0, 0.3}, {0.5, 0.25, 0.4}},
                               ConvexShape{{{0.3, 0.0, 0.1},
                                            {-0.1, 0.2, 0.1},
                                            {-0.1, -0.15, 0.1},
                                            {0.3, 0.0, 0.5},
                                            {-0.1, 0.2, 0.5},
                                            {-0.1, -0.15, 0.5}}},
                               CylinderShape{{0.1, 0.0, 0.3}, 0.17, 0.4}};
  int fitting = 0, not_fitting = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const World world = random_world(seed, seed % 2 ? 0.1 : 0.08, 30, 25, 0.04);
    for (const RobotShape& shape : shapes) {
      BodySlice slice;
      slice.shape = shape;
      const Grid<HeadingMask> headings = fitting_headings(world.voxels, slice, 0.0);
      const ContactTest contact(world, shape, 0.0);
      for (int n = static_cast<int>(seed); n < headings.frame.size(); n += 7) {
        const Cell c = headings.frame.at(n);
        const Eigen::Vector2d center = headings.frame.center(c);
        if (!column_free(world, c, slice)) {
          ASSERT_EQ(headings[c], kNoHeading);
          continue;
        }
        for (int k = 0; k < kHeadings; k += 3) {
          const Pose pose{{center.x(), center.y(), 0.0}, heading_at(k)};
          const bool fits = ((headings[c] >> k) & 1U) != 0;
          ASSERT_EQ(fits, !contact.in_contact(pose)) << seed << ' ' << n << ' ' << k;
          ++(fits ? fitting : not_fitting);
        }
      }
    }
  }
  EXPECT_GT(fitting, 1000);
  EXPECT_GT(not_fitting, 1000);
}

ReachableAreaOptions of_long_body() {
  ReachableAreaOptions options;
  options.slice.shape = BoxShape{{0, 0, 0.3}, {0.9, 0.5, 0.4}};
  options.range = 2.0;
  return options;
}

World two_rooms(const std::string& between) {
  return world_from_yaml(
      "resolution: 0.05\ntextures: {a: 1}\nstart: [1.5, 2, 0]\nrooms:\n"
      "  - {box: [0, 0, 4, 4], walls: a, floor: a}\n"
      "  - {box: [8, 0, 12, 4], walls: a, floor: a}\n" +
          between,
      "w");
}

TEST(ReachableArea, ALongBodyGetsThroughACorridorThatIsWideEnough) {
  const World world = two_rooms("  - {box: [4, 1.55, 8, 2.45], walls: a, floor: a}\n");
  const ReachableArea area = reachable_area(world, of_long_body());
  EXPECT_EQ(area.cells.get({110, 20}, 0), 1) << "the room behind";
  EXPECT_NEAR(area.area, 32.0 + 4.0 * 0.8, 0.7);
  EXPECT_LT(area.too_long_for, 0.1);
  // It does not turn there, and no further than its own length from either end.
  EXPECT_EQ(area.standing.get(world.voxels.frame().cell(6.0, 2.0), 0), 1);
  EXPECT_EQ(area.standing.get(world.voxels.frame().cell(6.0, 2.3), 0), 0);
}

TEST(ReachableArea, ALongBodyIsKeptFromWhatLiesBehindATightBend) {
  // 0.7 m wide, with a bend of 90 degrees: for a disc of its width there is room.
  const World world = two_rooms(
      "  - {box: [4, 1, 6, 1.7], walls: a, floor: a}\n"
      "  - {box: [5.3, 1, 6, 3.5], walls: a, floor: a}\n"
      "  - {box: [5.3, 2.8, 8, 3.5], walls: a, floor: a}\n");
  ReachableAreaOptions options = of_long_body();
  const ReachableArea area = reachable_area(world, options);
  EXPECT_EQ(area.cells.get({110, 20}, 0), 0) << "the room behind";
  EXPECT_GT(area.too_long_for, 15.0);
  options.slice.shape = CylinderShape{{0, 0, 0.3}, 0.25, 0.4};
  const ReachableArea disc = reachable_area(world, options);
  EXPECT_EQ(disc.cells.get({110, 20}, 0), 1);
  EXPECT_NEAR(area.area + area.too_long_for, disc.area, 1e-6);
}

TEST(ReachableArea, OutOfADeadEndABodyMustBackOut) {
  // Too narrow to turn in; its end is out of sight from its mouth.
  const World world = two_rooms("  - {box: [4, 1.6, 7.5, 2.3], walls: a, floor: a}\n");
  ReachableAreaOptions options = of_long_body();
  EXPECT_EQ(reachable_area(world, options).cells.get({73, 19}, 0), 1);
  options.free_moves = false;
  const ReachableArea forward_only = reachable_area(world, options);
  EXPECT_EQ(forward_only.cells.get({73, 19}, 0), 0);
  EXPECT_EQ(forward_only.cells.get({50, 19}, 0), 1) << "seen from the room";
  EXPECT_GT(forward_only.too_long_for, 0.5);
}

TEST(ReachableArea, AStartWithLittleRoomLeadsToTheSamePlaces) {
  World world = two_rooms("  - {box: [4, 1.55, 8, 2.45], walls: a, floor: a}\n");
  ReachableAreaOptions options;
  options.room = 0.05;
  const double area = reachable_area(world, options).area;
  world.start = {{0.19, 2.0, 0.0}, 0.0};  // less than room, by the column's centre
  EXPECT_EQ(reachable_area(world, options).area, area);
  // A body that cannot leave its place sees what is to be seen from there.
  World shut = world_from_yaml(
      "resolution: 0.05\ntextures: {a: 1}\nstart: [0.25, 0.25, 0]\nrooms:\n"
      "  - {box: [0, 0, 0.5, 0.5], walls: a, floor: a}\n",
      "w");
  options.room = 0.2;
  const ReachableArea here = reachable_area(shut, options);
  EXPECT_NEAR(here.area, 0.25, 0.1);
  EXPECT_EQ(std::count(here.standing.data.begin(), here.standing.data.end(), 1), 1);
}

TEST(ReachableArea, RoomsBeyondAreSeenThroughAnOpeningOnly) {
  const ReachableArea closed = reachable_area(slit_world(false));
  EXPECT_NEAR(closed.area, 39 * 38 * 0.01, 1e-9);
  const ReachableArea open = reachable_area(slit_world(true));
  EXPECT_GT(open.area, closed.area + 1.0);
  // A slit as deep as it is wide shows directions within 45 degrees; the robot keeps 0.18 m away.
  EXPECT_LT(open.area, closed.area + M_PI / 4.0 * 3.8 * 3.8);
  EXPECT_EQ(open.standing[(Cell{60, 20})], 0) << "the robot does not fit through";
  EXPECT_EQ(open.cells[(Cell{55, 20})], 1);
  EXPECT_EQ(open.cells[(Cell{43, 30})], 0);
  EXPECT_EQ(open.cells[(Cell{90, 20})], 0) << "out of range";
}

// No body enters them, and sensors look across: what lies far behind is not in the denominator.
TEST(ReachableArea, WhatZonesCutOffIsNotReachable) {
  const World world = load_world("corridor");
  for (const RobotShape& shape :
       {RobotShape(CylinderShape{}), RobotShape(BoxShape{.size = {0.6, 0.3, 0.3}})}) {
    ReachableAreaOptions options;
    options.slice.shape = shape;
    options.room = 0.01;
    options.range = 1.0;
    const ReachableArea all = reachable_area(world, options);
    Zones zones;
    const double x = world.start.position.x() + 3.0;
    zones.keep_out = {{{x, -50}, {x + 0.5, -50}, {x + 0.5, 50}, {x, 50}}};
    options.zones = std::make_shared<const ZoneMap>(zones);
    const ReachableArea part = reachable_area(world, options);
    EXPECT_LT(part.area, 0.7 * all.area);
    EXPECT_GT(part.area, 3.0);
    double farthest = -1e9;
    for (int n = 0; n < part.cells.frame.size(); ++n) {
      const std::size_t at = static_cast<std::size_t>(n);
      if (part.cells.data[at] == 0) continue;
      EXPECT_NE(all.cells.data[at], 0);
      farthest = std::max(farthest, part.cells.frame.center(part.cells.frame.at(n)).x());
    }
    EXPECT_GT(farthest, x) << "it is seen across the zone";
    EXPECT_LT(farthest, x + options.range);
  }
}

TEST(ReachableArea, StartMustBeFree) {
  World world = slit_world(true);
  for (const Eigen::Vector2d& at :
       {Eigen::Vector2d(4.05, 3.0), Eigen::Vector2d(0.05, 0.15), Eigen::Vector2d(-50.0, 2.0)}) {
    world.start.position.head<2>() = at;
    try {
      reachable_area(world);
      FAIL() << at.transpose();
    } catch (const InputError& e) {
      EXPECT_EQ(e.lines().size(), 1u);
      EXPECT_THAT(e.what(), ::testing::HasSubstr("slit: "));
      EXPECT_THAT(e.what(), ::testing::HasSubstr("expected"));
    }
  }
}

TEST(ReachableArea, BadOptionsAreRefused) {
  const World world = slit_world(true);
  const double bad[] = {0.0, -1.0, std::nan(""), HUGE_VAL};
  for (const double value : bad) {
    ReachableAreaOptions options;
    options.range = value;
    EXPECT_THROW(reachable_area(world, options), std::invalid_argument);
    options = {};
    options.map_resolution = value;
    EXPECT_THROW(reachable_area(world, options), std::invalid_argument);
    options = {};
    options.sensor_height = value == 0.0 ? 5.0 : value;
    EXPECT_THROW(reachable_area(world, options), std::invalid_argument);
  }
}

TEST(ReachableArea, IsFastAndAsExpectedOnRealMaps) {
  NOT_UNDER_SANITIZERS("costs, sizes and times are those of the release build");
  struct Case {
    const char* file;
    double low, high;  // [m^2]
  };
  // fr_079 and geb079 are the same corridor at two resolutions.
  for (const Case& c :
       {Case{"octomap/fr_079/fr_079.bt", 90, 115}, Case{"octomap/geb079/geb079.bt", 85, 110},
        Case{"maps2d/ipa_room_segmentation/Freiburg79_scan.png", 280, 320},
        Case{"maps2d/ros_willow_2010/willow-2010-02-18-0.10.yaml", 900, 1150}}) {
    const std::string path = std::string(PROSPECT_SHARED_DATA "/") + c.file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data: " << path;
    const World world = load_world(path);
    const auto begin = std::chrono::steady_clock::now();
    const ReachableArea area = reachable_area(world);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    EXPECT_GT(area.area, c.low) << c.file;
    EXPECT_LT(area.area, c.high) << c.file;
#ifdef NDEBUG
    if (!test::under_sanitizers()) {
      EXPECT_LT(seconds.count(), 3.0) << c.file;
    }
#endif
    RecordProperty(c.file, std::to_string(seconds.count()));
  }
}

}  // namespace
}  // namespace prospect::reachable_area_test
