// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/sensor_sight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "engine/maps/map_projection.h"
#include "models/make_model.h"
#include "perception/mapping/occupancy_mapper.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::sensor_sight_test {
namespace {

constexpr double kDegree = M_PI / 180.0;

struct Sensor {
  const char* name;
  RgbdFootprint footprint;
  double pitch;  // down [rad]
  int headings;  // that it looks to at each place
};

const Sensor kLidar{"lidar", {2.0 * M_PI, 0.0, 0.1, 5.0}, 0.0, 1};
const Sensor kTiltedLidar{"lidar, tilted by a degree", {2.0 * M_PI, 0.0, 0.1, 5.0}, kDegree, 1};
const Sensor kDepthCamera{"depth camera", {1.22, 0.95, 0.3, 4.0}, 15.0 * kDegree, 2};

const World& office() {
  static const World world = load_world("office", WorldOptions());
  return world;
}

struct Seen {
  double area = 0.0;        // of known cells [m^2]
  int free = 0, wrong = 0;  // cells said to be free; of these, solid at all heights of the body
};

// What a body from 0.05 to 0.45 m knows of the office after looks at fourteen places in it.
Seen look_round(const Sensor& sensor, double height, double resolution) {
  const World& world = office();
  DepthCameraOptions options;
  options.footprint = sensor.footprint;
  set_resolution(options);
  // Half the rays of an image, which cost half the time; errors no larger than those of a near
  // wall.
  if (options.rows > 1) options.columns /= 2;
  options.noise_quadratic = 0.0;
  const CameraMount mount{CameraMount::forward_facing({0.0, 0.0, height}, 0.0, sensor.pitch)};
  DepthCamera camera(world, options, mount, 1);
  OccupancyMapperOptions mapping;
  mapping.resolution = resolution;
  mapping.max_range = sensor.footprint.max_range;
  mapping.slice = {0.05, 0.45, height};
  OccupancyMapper mapper(mapping);
  double heading = 0.0;
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{2.0, 5.3},
                                                                   {5.0, 5.3},
                                                                   {8.0, 5.3},
                                                                   {11.0, 5.3},
                                                                   {14.0, 5.3},
                                                                   {17.0, 5.3},
                                                                   {3.0, 2.6},
                                                                   {8.0, 3.1},
                                                                   {12.5, 2.5},
                                                                   {17.2, 2.8},
                                                                   {5.0, 7.0},
                                                                   {9.0, 7.5},
                                                                   {12.4, 7.5},
                                                                   {16.7, 7.5}}) {
    for (int n = 0; n < sensor.headings; ++n) {
      const Pose pose{{x, y, 0.0}, heading};
      mapper.insert(transform(camera.sense(pose), pose));
      heading += 2.0 * M_PI / sensor.headings + 0.1;
    }
  }
  Seen seen;
  const auto ground = mapper.ground();
  const GridFrame& f = ground->frame();
  seen.area = (ground->free_cells() + ground->occupied_cells()) * resolution * resolution;
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    if (ground->state(c) != CellState::kFree) continue;
    ++seen.free;
    // Cells that are not the world's may be partly free.
    bool solid = true;
    for (const double x : {0.01, 0.99}) {
      for (const double y : {0.01, 0.99}) {
        const Eigen::Vector3i v =
            world.voxels.voxel({(c.i + x) * resolution, (c.j + y) * resolution, 0.05});
        for (int k = 0; k < 5; ++k) solid = solid && world.solid(v[0], v[1], k);
      }
    }
    seen.wrong += solid;
  }
  return seen;
}

// A map's lattice has nothing to do with where a sensor happens to be mounted: what is seen of the
// ground may not depend on it.
TEST(SensorSight, SeesTheOfficeFromAnyHeightAtAnyResolution) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  for (const Sensor& sensor : {kLidar, kTiltedLidar, kDepthCamera}) {
    for (const double resolution : {0.05, 0.07, 0.1}) {
      if (resolution == 0.07 && sensor.footprint.vertical_fov > 0.0) continue;  // dear
      double least = 1e9, most = 0.0;
      for (const double height : {0.06, 0.08, 0.10, 0.12,  0.14, 0.15,  0.18, 0.20, 0.21, 0.23,
                                  0.25, 0.28, 0.29, 0.295, 0.30, 0.305, 0.32, 0.35, 0.40, 0.42}) {
        SCOPED_TRACE(std::string(sensor.name) + " at " + std::to_string(height) + " m, voxels of " +
                     std::to_string(resolution) + " m");
        const Seen seen = look_round(sensor, height, resolution);
        EXPECT_GT(seen.area, 60.0);
        EXPECT_EQ(seen.wrong, 0) << "of " << seen.free;
        least = std::min(least, seen.area);
        most = std::max(most, seen.area);
      }
      std::printf("%-26s %.2f m: %.1f to %.1f m^2\n", sensor.name, resolution, least, most);
      if (sensor.pitch == 0.0) {
        EXPECT_GT(least, 0.99 * most) << sensor.name << ", voxels of " << resolution << " m";
      }
    }
  }
}

TEST(SensorSight, HeightsOfRays) {
  const auto heights = [](const RgbdFootprint& f, double z, double pitch, double roll = 0.0) {
    return heights_of_rays(f, {CameraMount::forward_facing({0.0, 0.0, z}, 0.3, pitch, roll)}, 0.1);
  };
  VerticalExtent h = heights({2.0 * M_PI, 0.0, 0.1, 5.0}, 0.3, 0.0);
  EXPECT_NEAR(h.z_min, 0.4, 1e-9);
  EXPECT_NEAR(h.z_max, 0.4, 1e-9);
  h = heights({2.0 * M_PI, 0.0, 0.1, 5.0}, 0.3, kDegree);  // down ahead, up behind
  EXPECT_NEAR(h.z_min, 0.4 - 5.0 * std::sin(kDegree), 1e-9);
  EXPECT_NEAR(h.z_max, 0.4 + 5.0 * std::sin(kDegree), 1e-9);
  h = heights({M_PI / 2.0, 0.0, 0.1, 5.0}, 0.3, kDegree);  // ahead only
  EXPECT_NEAR(h.z_min, 0.4 - 5.0 * std::sin(kDegree), 1e-9);
  EXPECT_NEAR(h.z_max, 0.4, 1e-9);
  h = heights({1.0, 0.5, 0.1, 4.0}, 1.0, 0.5);
  EXPECT_NEAR(h.z_min, 1.1 - 4.0 * std::sin(0.75), 1e-9);
  EXPECT_NEAR(h.z_max, 1.1, 1e-9) << "all rays fall";
  h = heights({1.0, 0.5, 0.1, 4.0}, 1.0, -0.5);
  EXPECT_NEAR(h.z_min, 1.1, 1e-9);
  EXPECT_NEAR(h.z_max, 1.1 + 4.0 * std::sin(0.75), 1e-9);
}

// Against all rays, by themselves.
TEST(SensorSight, HeightsOfRaysAreThoseOfEveryRay) {
  for (const double pitch : {-1.2, -0.3, 0.0, 0.4, 1.57}) {
    for (const double roll : {-2.0, 0.0, 0.7, 3.1}) {
      for (const RgbdFootprint& f :
           {RgbdFootprint{2.0 * M_PI, 0.0, 0.1, 5.0}, RgbdFootprint{1.2, 0.9, 0.1, 4.0},
            RgbdFootprint{6.0, 3.0, 0.1, 3.0}}) {
        const CameraMount mount{CameraMount::forward_facing({0.1, 0.0, 0.5}, 0.2, pitch, roll)};
        double low = 0.5, high = 0.5;
        for (int i = 0; i <= 200; ++i) {
          for (int j = 0; j <= 100; ++j) {
            const double a = f.horizontal_fov * (i / 200.0 - 0.5);
            const double e = f.vertical_fov * (j / 100.0 - 0.5);
            const Eigen::Vector3d d(std::sin(a) * std::cos(e), -std::sin(e),
                                    std::cos(a) * std::cos(e));
            const double z = 0.5 + f.max_range * (mount.T_BC.linear() * d).z();
            low = std::min(low, z);
            high = std::max(high, z);
          }
        }
        const VerticalExtent h = heights_of_rays(f, mount, 0.0);
        EXPECT_NEAR(h.z_min, low, 2e-3) << pitch << " " << roll;
        EXPECT_NEAR(h.z_max, high, 2e-3) << pitch << " " << roll;
      }
    }
  }
}

// One line, before anything is driven, for a sensor that sees nothing of where the body drives.
TEST(SensorSight, ASensorThatSeesNothingOfTheBodysHeightsIsRefused) {
  const auto problem = [](const std::string& depth, const std::string& more = "") {
    try {
      configuration_from_text(
          "robot:\n  shape: {type: cylinder, radius: 0.2, height: 0.4, center: [0, 0, 0.25]}\n"
          "  depth: {horizontal_fov: 360, " +
              depth + "}\n" + more,
          "robot.yaml");
      return std::string();
    } catch (const InputError& e) {
      return std::string(e.what());
    }
  };
  const auto level = [](const std::string& z) {
    return "vertical_fov: 0, max_range: 5, mount: {position: [0, 0, " + z + "]}";
  };
  for (const char* z : {"0.05", "0.1", "0.3", "0.45", "0.499"})
    EXPECT_EQ(problem(level(z)), "") << z;
  for (const char* z : {"0.5", "0.52", "1.2", "-0.01"}) {
    const std::string line = problem(level(z));
    EXPECT_THAT(line, testing::StartsWith("robot.yaml:3: robot.depth.mount.position")) << z;
    EXPECT_THAT(line, testing::HasSubstr("layers of voxels from 0.000 to 0.500 m")) << z;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
  // Finer voxels, thinner layers.
  EXPECT_EQ(problem(level("0.46"), "perception: {mapping: {resolution: 0.1}}\n"), "");
  EXPECT_NE(problem(level("0.46"), "perception: {mapping: {resolution: 0.05}}\n"), "");
  // A sensor above the body that looks down, or is tilted, sees it.
  EXPECT_EQ(problem("vertical_fov: 0, max_range: 5, mount: {position: [0, 0, 0.55], pitch: 5}"),
            "");
  EXPECT_EQ(problem("vertical_fov: 50, max_range: 5, mount: {position: [0, 0, 1.5]}"), "");
  EXPECT_NE(problem("vertical_fov: 50, max_range: 1, mount: {position: [0, 0, 1.5]}"), "");
}

}  // namespace
}  // namespace prospect::sensor_sight_test
