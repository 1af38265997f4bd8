// SPDX-License-Identifier: Apache-2.0
// The closed loop by sight: rendered images through the perception of a robot, nothing but the
// start taken from the truth.
#include "adapters/robots/simulator/camera_sensors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>

#include "adapters/formats/files/not_built_in.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/maps/map_projection.h"
#include "tests/adapters/box_room.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::camera_sensors_test {
namespace {

class CameraSensorsTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      const SceneRenderer renderer(triangle());
    } catch (const NotBuiltIn& absent) {
      GTEST_SKIP() << absent.what();
    }
  }
  static TexturedMesh triangle() {
    TexturedMesh mesh;
    mesh.vertices = {{1, 0, 0}, {1, 1, 0}, {1, 0, 1}};
    mesh.uv = {{0, 0}, {1, 0}, {0, 1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material = {0};
    mesh.textures = {Image(1, 1, 128)};
    return mesh;
  }
};

std::shared_ptr<World> room_with_an_opening() {
  auto world = std::make_shared<World>(test::box_room(7.0, 5.0, 2.2, 0.1, 30.0));
  test::fill(*world, {4.0, 0.0, 0.0}, {4.1, 3.4, 2.2});
  test::fill(*world, {1.8, 3.6, 0.0}, {2.6, 4.0, 0.8});
  world->start.position = {1.2, 1.2, 0.0};
  return world;
}

/// Half the pixels each way: the same field of view in a quarter of the time.
SimulatorOptions small_cameras() {
  SimulatorOptions options;
  options.sensors = Sensors::kCamera;
  options.features.stereo.left = {225.0, 225.0, 160.0, 120.0, 320.0, 240.0};
  options.camera.rig.depth_width = 160;
  options.camera.rig.depth_height = 120;
  return options;
}

/// Of exact geometry, for tests that measure against the true one.
SimulatorOptions ideal_cameras() {
  SimulatorOptions options = small_cameras();
  options.camera.realism = 0.0;
  return options;
}

Twist twist(double v, double w) {
  Twist t;
  t.linear.x() = v;
  t.yaw_rate = w;
  return t;
}

void tour(Simulator& simulator) {
  simulator.apply(twist(0.0, 0.8), 2.0 * M_PI / 0.8);
  simulator.apply(twist(0.4, 0.3), 5.0);
  simulator.apply(twist(0.0, -0.8), 2.0);
}

TEST_F(CameraSensorsTest, FollowsTheRobotAndMapsWhatIsThere) {
  const auto world = room_with_an_opening();
  Simulator simulator(world, ideal_cameras());
  const auto first = simulator.sense();
  EXPECT_EQ(first->pose.position, world->start.position);
  EXPECT_GT(first->ground->free_cells(), 100);
  tour(simulator);
  EXPECT_EQ(simulator.collisions(), 0);
  const auto belief = simulator.sense();
  EXPECT_EQ(belief->localization, Localization::kOk);
  EXPECT_EQ(simulator.losses(), 0);
  EXPECT_GT(belief->tracked_features, 40);
  EXPECT_LT(simulator.localization_error(), 0.02);
  EXPECT_NEAR(belief->twist.yaw_rate, -0.8, 0.1);
  // What it calls free or occupied is so, but for the cells at the edge of things.
  const SliceLayers layers = slice_layers({0.1, 0.5}, 0.1);
  int known = 0, wrong = 0;
  const GridFrame f = belief->ground->frame();
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    const CellState state = belief->ground->state(c);
    if (state == CellState::kUnknown) continue;
    bool solid = false, solid_near = false;
    for (int k = layers.k_low; k <= layers.k_high; ++k) {
      solid |= world->solid(c.i, c.j, k);
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) solid_near |= world->solid(c.i + i, c.j + j, k);
      }
    }
    ++known;
    wrong += state == CellState::kFree ? solid : !solid_near;
  }
  std::printf("%.2f m and %.1f rad: off by %.1f mm, %d of %d cells wrong\n",
              simulator.path_length(), simulator.rotation(), 1e3 * simulator.localization_error(),
              wrong, known);
  EXPECT_GT(known, 1200);
  EXPECT_LT(wrong, known / 100);
  // Landmarks lie on surfaces.
  int off = 0;
  for (const Landmark& l : belief->landmarks->landmarks) {
    bool surface = false;
    for (const double dx : {-0.1, 0.0, 0.1}) {
      for (const double dy : {-0.1, 0.0, 0.1}) {
        for (const double dz : {-0.1, 0.0, 0.1}) {
          const Eigen::Vector3d p = (l.position + Eigen::Vector3d(dx, dy, dz)) / 0.1;
          surface |=
              world->solid(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())),
                           static_cast<int>(std::floor(p.z())));
        }
      }
    }
    off += !surface;
  }
  EXPECT_LT(off, static_cast<int>(belief->landmarks->landmarks.size()) / 10);
  EXPECT_EQ(simulator.picture().image->width, 320);
  EXPECT_GT(simulator.picture().sightings.size(), 40U);
}

/// A room of plain walls on a floor of tiles, each like the other.
std::shared_ptr<World> tiled_room(double length, double width, double tile) {
  auto world = std::make_shared<World>(test::box_room(length, width, 2.2, 0.1, 0.0));
  TexturedMesh mesh;
  Image speckled(4, 4);
  std::mt19937 generator(7);
  for (auto& pixel : speckled.pixels) pixel = static_cast<std::uint8_t>(20 + generator() % 200);
  mesh.textures = {speckled, Image(1, 1, 150)};
  const float l = static_cast<float>(length), w = static_cast<float>(width), h = 2.2f;
  const auto quad = [&](const std::array<Eigen::Vector3f, 4>& corners, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& c : corners) {
      mesh.vertices.push_back(c);
      mesh.uv.emplace_back(c.head<2>() / static_cast<float>(tile));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.material.insert(mesh.material.end(), 2, material);
  };
  quad({{{0, 0, 0}, {l, 0, 0}, {l, w, 0}, {0, w, 0}}}, 0);
  quad({{{0, 0, 0}, {l, 0, 0}, {l, 0, h}, {0, 0, h}}}, 1);
  quad({{{0, w, 0}, {l, w, 0}, {l, w, h}, {0, w, h}}}, 1);
  quad({{{0, 0, 0}, {0, w, 0}, {0, w, h}, {0, 0, h}}}, 1);
  quad({{{l, 0, 0}, {l, w, 0}, {l, w, h}, {l, 0, h}}}, 1);
  world->mesh = std::make_shared<const TexturedMesh>(std::move(mesh));
  return world;
}

TEST_F(CameraSensorsTest, OnATiledFloorTheWheelsTellWhichTile) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  Simulator simulator(tiled_room(9.0, 7.0, 0.15), ideal_cameras());
  // Another tile than the right one is a jump of a tile, and stays. A floor is seen at a slant, and
  // every tile has the same corners: what that does to one is done to all, and drifts.
  constexpr double kTile = 0.15;
  double worst = 0.0, jump = 0.0, before = 0.0;
  for (int k = 0; k < 12; ++k) {
    simulator.apply(twist(0.5, k % 2 ? -0.6 : 0.6), 0.5);
    const double error = simulator.localization_error();
    worst = std::max(worst, error);
    jump = std::max(jump, std::abs(error - before));
    before = error;
  }
  std::printf("%.2f m: off by %.1f mm at most, %d losses\n", simulator.path_length(), 1e3 * worst,
              simulator.losses());
  EXPECT_LT(jump, 0.1 * kTile);
  EXPECT_LT(worst, 0.03);
}

TEST_F(CameraSensorsTest, SameSeedSameBitsWithAnyNumberOfThreads) {
  const auto world = room_with_an_opening();
  SimulatorOptions one = small_cameras(), two = one, other = one;
  two.camera.rig.threads = 2;
  other.seed = 2;
  Simulator a(world, one), b(world, two), c(world, other);
  for (Simulator* s : {&a, &b, &c}) {
    s->apply(twist(0.3, 0.4), 2.0);
  }
  EXPECT_EQ(a.estimated_pose().position, b.estimated_pose().position);
  EXPECT_EQ(a.estimated_pose().yaw, b.estimated_pose().yaw);
  EXPECT_EQ(a.picture().image->pixels, b.picture().image->pixels);
  EXPECT_EQ(a.sense()->voxels->data(), b.sense()->voxels->data());
  EXPECT_NE(a.estimated_pose().position, c.estimated_pose().position);
}

TEST_F(CameraSensorsTest, AMissionWithPeopleIsTheSameAgain) {
  const auto world = room_with_an_opening();
  SimulatorOptions one = small_cameras();
  one.camera.effects.people = 8.0;  // two or three in so small a room
  SimulatorOptions two = one, other = one, ideal = one;
  two.camera.rig.threads = 2;
  other.seed = 2;
  ideal.camera.realism = 0.0;
  Simulator a(world, one), b(world, two), c(world, other), d(world, ideal);
  for (Simulator* s : {&a, &b, &c, &d}) {
    s->apply(twist(0.3, 0.4), 3.0);
  }
  EXPECT_EQ(a.estimated_pose().position, b.estimated_pose().position);
  EXPECT_EQ(a.picture().image->pixels, b.picture().image->pixels);
  EXPECT_EQ(a.sense()->voxels->data(), b.sense()->voxels->data());
  EXPECT_NE(a.estimated_pose().position, c.estimated_pose().position);
  EXPECT_NE(a.picture().image->pixels, d.picture().image->pixels);
  std::printf("%.2f m: off by %.1f and %.1f mm, ideal cameras by %.1f mm\n", a.path_length(),
              1e3 * a.localization_error(), 1e3 * c.localization_error(),
              1e3 * d.localization_error());
  EXPECT_EQ(a.losses(), 0);
  EXPECT_LT(a.localization_error(), 0.1 * a.path_length());
}

TEST_F(CameraSensorsTest, WhiteWallsAreARealLossAndTheWayBackEndsIt) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  const auto world = test::half_white_room(9.0, 4.0);
  for (const bool wheels : {true, false}) {
    PerceptionOptions perception = simulated_perception();
    perception.wheels = wheels;
    Simulator simulator(world, small_cameras(), perception);
    simulator.apply(twist(0.5, 0.0), 3.0);
    EXPECT_NE(simulator.sense()->localization, Localization::kLost);
    simulator.apply(twist(0.0, 0.6), 0.5);
    simulator.apply(twist(0.5, 0.0), 6.0);
    const auto lost = simulator.sense();
    EXPECT_EQ(lost->localization, Localization::kLost);
    EXPECT_GE(simulator.losses(), 1);
    EXPECT_GT(simulator.lost_time(), 0.5);
    const double error = simulator.localization_error();
    if (wheels) {
      EXPECT_LT(error, 0.3) << "dead reckoning";
    } else {
      EXPECT_GT(error, 0.3) << "the pose is held";
    }
    EXPECT_GT(lost->covariance.block(0, 0, 2, 2).trace(), 1e-4);
    // Back, facing the same way.
    simulator.apply(twist(-0.5, 0.0), 6.0);
    simulator.apply(twist(0.0, -0.6), 0.5);
    const auto found = simulator.sense();
    std::printf("%s wheels: off by %.3f m when lost, %.3f m back\n", wheels ? "with" : "without",
                error, simulator.localization_error());
    EXPECT_NE(found->localization, Localization::kLost);
    EXPECT_EQ(simulator.collisions(), 0);
    EXPECT_LT(simulator.localization_error(), 0.03) << "found by the keyframes of before";
  }
}

TEST_F(CameraSensorsTest, AMissionExploresByWhatTheCamerasSee) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  const auto world = room_with_an_opening();
  Configuration configuration = configuration_from_text(
      "simulator:\n  sensors: camera\n"
      "robot:\n  stereo: {fx: 225, fy: 225, cx: 160, cy: 120, width: 320, height: 240}\n"
      "mission:\n  time_limit: 20\n",
      "test");
  configuration.simulator.camera.rig.depth_width = 160;
  configuration.simulator.camera.rig.depth_height = 120;
  const ExplorationRunResult result = run_exploration(world, configuration, {});
  const Summary& s = result.record.summary;
  std::printf("%.1f m, coverage %.2f, error %.1f mm, %d of %d steps fell back\n", s.path_length_m,
              s.coverage, 1e3 * s.localization_final_m, s.fallbacks, s.steps);
  EXPECT_EQ(s.collisions, 0);
  EXPECT_GT(s.coverage, 0.5);
  EXPECT_GT(s.path_length_m, 2.0);
  EXPECT_LT(s.localization_final_m, 0.02 * s.path_length_m);  // vision alone: 0.5 to 2 %
}

TEST_F(CameraSensorsTest, RefusesACalibrationThatTheDepthCameraContradicts) {
  for (const double error : {-0.25, 0.25, 0.5}) {
    for (const bool focal : {false, true}) {
      SimulatorOptions options = small_cameras();
      (focal ? options.camera.focal_error : options.camera.baseline_error) = error;
      try {
        Simulator(room_with_an_opening(), options);
        ADD_FAILURE() << "taken: " << (focal ? "focal length " : "baseline ") << error;
      } catch (const std::invalid_argument& refusal) {
        std::printf("%s off by %+.0f %%: %s\n", focal ? "focal length" : "baseline", 100.0 * error,
                    refusal.what());
        EXPECT_NE(std::string(refusal.what()).find("those of the depth camera"), std::string::npos)
            << refusal.what();
      }
    }
  }
}

// At once, or when the disparities' zero is known.
TEST_F(CameraSensorsTest, ATenthIsNoticed) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  for (const double error : {-0.1, 0.01, 0.1}) {
    SimulatorOptions options = small_cameras();
    options.camera.baseline_error = error;
    std::optional<Simulator> begun;
    try {
      begun.emplace(room_with_an_opening(), options);
    } catch (const std::invalid_argument& refused) {
      EXPECT_GT(std::abs(error), 0.05) << refused.what();
      continue;
    }
    Simulator& simulator = *begun;
    double way = -1.0;
    for (int k = 0; k < 12 && way < 0.0; ++k) {
      simulator.apply(twist(0.3, 0.5), 0.5);
      if (simulator.sense()->localization == Localization::kLost) way = simulator.path_length();
      EXPECT_TRUE(way < 0.0 || !simulator.complaint().empty());
    }
    std::printf("baseline off by %+.0f %%: lost after %.1f m\n", 100.0 * error, way);
    EXPECT_EQ(way > 0.0, std::abs(error) > 0.05);
    EXPECT_EQ(simulator.complaint().empty(), way < 0.0);
  }
}

TEST_F(CameraSensorsTest, WithoutDepthsInCommonTheWheelsContradictACalibration) {
  NOT_UNDER_SANITIZERS("missions go the ways of drives and of steps");
  SimulatorOptions options = small_cameras();
  // The depth camera looks back, where the stereo pair does not.
  options.depth_mount.T_BC = CameraMount::forward_facing({0.0, 0.0, 0.45}, M_PI, 0.3);
  options.camera.baseline_error = 0.4;
  Simulator simulator(room_with_an_opening(), options);
  simulator.apply(twist(0.0, 0.8), 2.0);
  EXPECT_NE(simulator.sense()->localization, Localization::kLost);
  EXPECT_EQ(simulator.complaint(), "");
  simulator.apply(twist(0.0, -0.8), 2.0);
  for (int there_and_back = 0; there_and_back < 2; ++there_and_back) {
    simulator.apply(twist(0.4, 0.0), 3.0);
    simulator.apply(twist(-0.4, 0.0), 3.0);
  }
  EXPECT_EQ(simulator.sense()->localization, Localization::kLost);
  EXPECT_NE(simulator.complaint().find("that by the wheels"), std::string::npos)
      << simulator.complaint();
}

TEST_F(CameraSensorsTest, RefusesOptionsOutOfRange) {
  SimulatorOptions options = small_cameras();
  options.camera.texture_quality = 2.0;
  EXPECT_THROW(Simulator(room_with_an_opening(), options), std::invalid_argument);
  options = small_cameras();
  options.camera.rig.exposure = -1.0;
  EXPECT_THROW(Simulator(room_with_an_opening(), options), std::invalid_argument);
  options = small_cameras();
  PerceptionOptions perception = simulated_perception();
  perception.wheel_fusion.gate = 0.0;
  EXPECT_THROW(Simulator(room_with_an_opening(), options, perception), std::invalid_argument);
  options.wheels.turn = -1.0;
  EXPECT_THROW(Simulator(room_with_an_opening(), options), std::invalid_argument);
  options = small_cameras();
  options.camera.focal_error = -1.0;
  EXPECT_THROW(Simulator(room_with_an_opening(), options), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::camera_sensors_test
