// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/scene_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "perception/odometry/rotation_between.h"
#include "tests/adapters/box_room.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::scene_renderer_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

TexturedMesh mesh_of(const World& world, double quality = 1.0) {
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, 1); }, 1);
  return world_mesh(world, field, {quality});
}

/// A camera of one pixel that looks from `from` along `direction`.
struct Needle {
  PinholeCamera camera;
  Isometry3d T_WC;
  Needle(const Vector3d& from, const Vector3d& direction) {
    camera = {1.0, 1.0, 0.0, 0.0, 1.0, 1.0};
    T_WC = Isometry3d::Identity();
    T_WC.linear() = rotation_between(Vector3d::UnitZ(), direction).toRotationMatrix();
    T_WC.translation() = from;
  }
};

Pose somewhere_free(const World& world, std::mt19937& generator) {
  const GridFrame& f = world.voxels.frame();
  const double r = f.resolution;
  std::uniform_real_distribution<double> x(f.i0 * r, (f.i0 + f.width) * r),
      y(f.j0 * r, (f.j0 + f.height) * r), yaw(-3.1, 3.1);
  while (true) {
    Pose pose;
    pose.position = {x(generator), y(generator), 0.0};
    pose.yaw = yaw(generator);
    const Eigen::Vector3i v = world.voxels.voxel(pose.position + Vector3d(0, 0, 0.45));
    if (!world.solid(v[0], v[1], v[2])) return pose;
  }
}

TEST(SceneRenderer, DepthIsThatOfTheVoxels) {
  const World world = load_world("office_bare");
  const SceneRenderer scene(mesh_of(world));
  DepthCameraOptions exact;
  exact.noise_constant = exact.noise_quadratic = exact.dropout = 0.0;
  exact.footprint.min_range = 0.0;
  exact.footprint.max_range = 50.0;
  exact.footprint.vertical_fov = 2.0;
  const CameraMount mount;
  DepthCamera voxels(world, exact, mount, 1);
  std::mt19937 generator(1);
  int rays = 0, apart = 0;
  double worst = 0.0;
  for (int n = 0; n < 12; ++n) {
    const Pose pose = somewhere_free(world, generator);
    const DepthScan scan = transform(voxels.sense(pose), pose);
    ASSERT_TRUE(scan.misses.empty());
    for (const Vector3d& hit : scan.hits) {
      const Needle needle(scan.origin, hit - scan.origin);
      const double z = scene.depth(needle.camera, needle.T_WC).at(0, 0);
      const double error = std::abs(z - (hit - scan.origin).norm());
      ++rays;
      // A ray that passes an edge within the overlap may end there instead.
      if (!(error < 1e-3)) {
        ++apart;
      } else {
        worst = std::max(worst, error);
      }
    }
  }
  std::printf("%d rays, largest difference %.3f mm, %d at edges\n", rays, 1e3 * worst, apart);
  EXPECT_EQ(rays, 12 * 4800);
  EXPECT_LT(worst, 1e-4);
  EXPECT_LE(apart, rays / 10000);
}

TEST(SceneRenderer, ImageDepthIsAlongTheOpticalAxis) {
  const World world = test::box_room(4.0, 4.0);
  const SceneRenderer scene(mesh_of(world));
  const PinholeCamera camera{90.0, 80.0, 60.0, 50.0, 130.0, 101.0};
  Pose pose = world.start;
  pose.yaw = 0.3;
  const Isometry3d T_WC = camera_pose(pose, CameraMount{});
  std::vector<float> incidence;
  const DepthImage depth = scene.depth(camera, T_WC, 1, &incidence);
  ASSERT_EQ(depth.width, 130);
  ASSERT_EQ(depth.height, 101);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      const Vector3d ray = T_WC.linear() * pixel_ray(camera, u, v);
      const Vector3d p = T_WC.translation() + depth.at(u, v) * ray;
      // On one of the six planes of the room, which gives the incidence, too.
      const Eigen::Matrix<double, 6, 1> off =
          (Eigen::Matrix<double, 6, 1>() << p, Vector3d(4, 4, 2) - p).finished();
      int plane = 0;
      EXPECT_LT(std::abs(off.cwiseAbs().minCoeff(&plane)), 1e-4) << u << ' ' << v;
      EXPECT_NEAR(incidence[static_cast<std::size_t>(v * depth.width + u)],
                  std::abs(ray.normalized()[plane % 3]), 1e-4);
    }
  }
}

TEST(SceneRenderer, NoRaySlipsThrough) {
  // Voxels at random: rectangles meet in every way there is. Rays to all their corners, where
  // floating point would let one through first, and images full of other rays.
  World world = test::box_room(3.0, 3.0, 2.0);
  std::mt19937 generator(3);
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < 30; ++i) {
      for (int k = 0; k < 20; ++k) {
        const bool middle = std::abs(i - 14) < 3 && std::abs(j - 14) < 3;
        if (!middle && generator() % 8 == 0) world.voxels.set(i, j, k, CellState::kOccupied);
      }
    }
  }
  const TexturedMesh mesh = mesh_of(world, 0.0);
  const SceneRenderer scene(mesh);
  const Vector3d from(1.437, 1.521, 1.013);
  int slipped = 0;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    // The corner of the faces, not that of the rectangle reaching beyond it.
    const Vector3d corner = (vertex.cast<double>() * 10.0).array().round() / 10.0;
    const Needle needle(from, corner - from);
    const double z = scene.depth(needle.camera, needle.T_WC).at(0, 0);
    slipped += !(z < (corner - from).norm() + 1e-3);
  }
  std::printf("%d of %zu corners let a ray through\n", slipped, mesh.vertices.size());
  EXPECT_EQ(slipped, 0);

  PinholeCamera camera;
  for (int n = 0; n < 8; ++n) {
    Pose pose;
    pose.position = from - Vector3d(0, 0, 0.45);
    pose.yaw = 0.8 * n;
    const DepthImage depth = scene.depth(camera, camera_pose(pose, CameraMount{}));
    EXPECT_TRUE(std::all_of(depth.depth.begin(), depth.depth.end(),
                            [](float z) { return z > 0.0f && z < 4.0f; }));
  }
}

TEST(SceneRenderer, SameBitsWithAnyNumberOfThreads) {
  NOT_UNDER_SANITIZERS("the release build compares bits");
  const World world = load_world("office_bare");
  const SceneRenderer scene(mesh_of(world));
  const SceneRenderer again(mesh_of(world));
  PinholeCamera camera;
  camera.width = 639.0;  // not a whole number of packets
  camera.height = 477.0;
  std::mt19937 generator(2);
  for (int n = 0; n < 5; ++n) {
    const Isometry3d T_WC = camera_pose(somewhere_free(world, generator), CameraMount{});
    const std::vector<float> one = scene.intensity(camera, T_WC, 1);
    const DepthImage depth = scene.depth(camera, T_WC, 1);
    for (const int threads : {2, 3, 7}) {
      EXPECT_EQ(one, scene.intensity(camera, T_WC, threads));
      EXPECT_TRUE(depth.same(scene.depth(camera, T_WC, threads)));
    }
    EXPECT_EQ(one, again.intensity(camera, T_WC, 1));
  }
}

TEST(SceneRenderer, PixelsAreMeansOverTheirArea) {
  NOT_UNDER_SANITIZERS("statistics repeat a step of other tests a thousand times");
  // Against the mean of 8 x 8 pixels of an image eight times as large.
  const World world = load_world("office_bare");
  const SceneRenderer scene(mesh_of(world));
  const PinholeCamera camera{225.0, 225.0, 159.5, 119.5, 320.0, 240.0};
  constexpr int k = 8;
  const PinholeCamera fine{k * camera.fx,
                           k * camera.fy,
                           k * camera.cx + 0.5 * (k - 1),
                           k * camera.cy + 0.5 * (k - 1),
                           k * camera.width,
                           k * camera.height};
  std::mt19937 generator(5);
  double squares = 0.0, signal = 0.0;
  int far_off = 0, count = 0;
  for (int n = 0; n < 4; ++n) {
    const Isometry3d T_WC = camera_pose(somewhere_free(world, generator), CameraMount{});
    const std::vector<float> image = scene.intensity(camera, T_WC);
    const std::vector<float> large = scene.intensity(fine, T_WC);
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        double mean = 0.0, square = 0.0;
        for (int b = 0; b < k; ++b) {
          for (int a = 0; a < k; ++a) {
            const double g = large[static_cast<std::size_t>((v * k + b) * 320 * k + u * k + a)];
            mean += g / (k * k);
            square += g * g / (k * k);
          }
        }
        const double error = image[static_cast<std::size_t>(v * 320 + u)] - mean;
        squares += error * error;
        signal += square - mean * mean;
        far_off += std::abs(error) > 15.0;
        ++count;
      }
    }
  }
  const double rms = std::sqrt(squares / count);
  std::printf("error of a pixel: %.2f grey levels rms, %.3f %% above 15; a single ray's: %.2f\n",
              rms, 100.0 * far_off / count, std::sqrt(signal / count));
  EXPECT_LT(rms, 2.0);
  EXPECT_LT(rms, 0.5 * std::sqrt(signal / count));
  EXPECT_LT(far_off, count / 500);
}

TEST(SceneRenderer, ShadesByDirection) {
  // A plain square from both sides, and the background beside it.
  TexturedMesh mesh;
  mesh.vertices = {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}};
  mesh.uv.assign(4, {0.0f, 0.0f});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = {0, 0};
  mesh.textures = {Image(1, 1, 200)};
  SceneRendererOptions options;
  options.light = {-2.0, 0.0, 0.0};
  options.ambient = 0.4;
  options.background = 33.0;
  const SceneRenderer scene(mesh, options);
  const Needle lit({0, 0.2, 0.1}, {1, 0, 0}), dark({2, 0.2, 0.1}, {-1, 0, 0}),
      beside({0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(scene.grey(lit.camera, lit.T_WC).at(0, 0), 200);
  EXPECT_EQ(scene.grey(dark.camera, dark.T_WC).at(0, 0), 80);
  EXPECT_EQ(scene.grey(beside.camera, beside.T_WC).at(0, 0), 33);
  EXPECT_TRUE(std::isnan(scene.depth(beside.camera, beside.T_WC).at(0, 0)));
}

TEST(SceneRenderer, ContrastIsAboutTheMean) {
  TexturedMesh mesh;
  mesh.vertices = {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = {0, 0};
  mesh.textures = {Image(2, 1, 60)};
  mesh.textures[0].at(1, 0) = 180;
  for (const double contrast : {1.0, 0.5, 0.0}) {
    SceneRendererOptions options;
    options.ambient = 1.0;
    options.texture_contrast = contrast;
    const SceneRenderer scene(mesh, options);
    // In the middles of the texture's two pixels.
    const Needle dark({0, -0.5, 0.1}, {1, 0, 0}), bright({0, 0.5, 0.1}, {1, 0, 0});
    EXPECT_NEAR(scene.grey(dark.camera, dark.T_WC).at(0, 0), 120 - 60 * contrast, 1);
    EXPECT_NEAR(scene.grey(bright.camera, bright.T_WC).at(0, 0), 120 + 60 * contrast, 1);
  }
  SceneRendererOptions wrong;
  wrong.texture_contrast = 1.1;
  EXPECT_THROW(SceneRenderer(mesh, wrong), std::invalid_argument);
}

TEST(SceneRenderer, SurfacesSeenEdgeOn) {
  // The eye in the plane of a textured floor, just above and below it, and in its very edge; a
  // texture that repeats as often as it may.
  TexturedMesh mesh;
  mesh.vertices = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  mesh.uv = {{-9e4f, -9e4f}, {9e4f, -9e4f}, {9e4f, 9e4f}, {-9e4f, 9e4f}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = {0, 0};
  mesh.textures = {Image(64, 64, 90)};
  for (int n = 0; n < 64; ++n) mesh.textures[0].at(n, (7 * n) % 64) = 250;
  const SceneRenderer scene(mesh);
  const PinholeCamera camera{20.0, 20.0, 32.0, 24.0, 65.0, 49.0};
  for (const double z : {0.0, 1e-12, 1e-9, -1e-7, 1e-5, 1e-3, 0.1}) {
    for (const double yaw : {0.0, 0.5, 0.7853981633974483}) {
      Pose pose;
      pose.position = {0.0, 0.0, z - 0.45};
      pose.yaw = yaw;
      const Isometry3d T_WC = camera_pose(pose, CameraMount{});
      for (const float grey : scene.intensity(camera, T_WC)) {
        ASSERT_GE(grey, 0.0f);
        ASSERT_LE(grey, 255.0f);
      }
      for (const float depth : scene.depth(camera, T_WC).depth) {
        ASSERT_TRUE(std::isnan(depth) || (depth > 0.0f && std::isfinite(depth)));
      }
    }
  }
}

TEST(SceneRenderer, RefusesABrokenMesh) {
  TexturedMesh whole;
  whole.vertices = {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}};
  whole.uv.assign(3, {0.0f, 0.0f});
  whole.triangles = {{0, 1, 2}};
  whole.material = {0};
  whole.textures = {Image(1, 1, 200)};
  EXPECT_NO_THROW(SceneRenderer{whole});
  const auto refused = [&](auto&& damage) {
    TexturedMesh mesh = whole;
    damage(mesh);
    EXPECT_THROW(SceneRenderer{mesh}, std::invalid_argument);
  };
  refused([](TexturedMesh& m) { m.triangles[0][1] = 3; });
  refused([](TexturedMesh& m) { m.material[0] = 1; });
  refused([](TexturedMesh& m) { m.material.clear(); });
  refused([](TexturedMesh& m) { m.uv.pop_back(); });
  refused([](TexturedMesh& m) { m.textures[0] = Image(); });
  refused([](TexturedMesh& m) { m.vertices[2].x() = std::numeric_limits<float>::quiet_NaN(); });
  refused([](TexturedMesh& m) { m.uv[2].y() = std::numeric_limits<float>::infinity(); });
  // Without an area, or without triangles: nothing to see, but nothing wrong.
  TexturedMesh thin = whole;
  thin.vertices[2] = thin.vertices[1];
  const Needle needle({0, 0, 0}, {1, 0, 0});
  EXPECT_TRUE(std::isnan(SceneRenderer(thin).depth(needle.camera, needle.T_WC).at(0, 0)));
  EXPECT_TRUE(std::isnan(SceneRenderer(TexturedMesh{}).depth(needle.camera, needle.T_WC).at(0, 0)));

  const SceneRenderer scene(whole);
  Needle lost = needle;
  lost.T_WC.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(scene.grey(lost.camera, lost.T_WC), std::invalid_argument);
  Needle blind = needle;
  blind.camera.fx = 0.0;
  EXPECT_THROW(scene.depth(blind.camera, blind.T_WC), std::invalid_argument);
  blind.camera = needle.camera;
  blind.camera.width = 1e6;
  EXPECT_THROW(scene.depth(blind.camera, blind.T_WC), std::invalid_argument);
}

/// A floor of one grey, a wall 4 m ahead whose lower half is dark and whose upper half is bright.
TexturedMesh wall_above_a_floor() {
  TexturedMesh mesh;
  mesh.textures = {Image(1, 1, 100), Image(1, 1, 40), Image(1, 1, 220)};
  const auto quad = [&](const std::array<Eigen::Vector3f, 4>& corners, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& c : corners) {
      mesh.vertices.push_back(c);
      mesh.uv.emplace_back(0.5f, 0.5f);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.material.insert(mesh.material.end(), 2, material);
  };
  quad({{{0, -9, 0}, {4, -9, 0}, {4, 9, 0}, {0, 9, 0}}}, 0);
  quad({{{4, -9, 0}, {4, 9, 0}, {4, 9, 0.5f}, {4, -9, 0.5f}}}, 1);
  quad({{{4, -9, 0.5f}, {4, 9, 0.5f}, {4, 9, 6}, {4, -9, 6}}}, 2);
  return mesh;
}

TEST(SceneRenderer, AFloorThatShinesMirrorsWhatIsBehindIt) {
  const TexturedMesh mesh = wall_above_a_floor();
  SceneRendererOptions flat;
  flat.ambient = 1.0;  // albedos as they are
  SceneRendererOptions shiny = flat;
  shiny.floor_shine = 0.04;
  const SceneRenderer dull(mesh, flat), scene(mesh, shiny);
  const PinholeCamera camera;
  Pose pose;
  pose.position.x() = 0.5;
  const Isometry3d T_WC = camera_pose(pose, CameraMount());  // 0.45 m up, 3.5 m from the wall
  const std::vector<float> without = dull.intensity(camera, T_WC),
                           with = scene.intensity(camera, T_WC);
  EXPECT_EQ(with, scene.intensity(camera, T_WC, 2)) << "with any number of threads";
  int mirrored = 0;
  for (int v = 0; v < 480; ++v) {
    const auto at = static_cast<std::size_t>(v * 640 + 320);
    const double below = (v - camera.cy) / camera.fy;  // drop of the ray a metre
    const double distance = below > 0.0 ? 0.45 / below : 1e9;
    if (distance > 3.4) {
      if (distance > 3.6) {
        ASSERT_EQ(with[at], without[at]) << "the wall shines not, row " << v;
      }
      continue;
    }
    const double height = below * (3.5 - distance);  // at which the mirrored ray meets the wall
    if (std::abs(height - 0.5) < 0.05) continue;     // it is blurred there
    const double past = 1.0 - below / std::hypot(below, 1.0);
    const double share = 0.04 * (1.0 + 24.0 * std::pow(past, 5));
    ASSERT_NEAR(with[at], (1.0 - share) * 100.0 + share * (height < 0.5 ? 40.0 : 220.0), 0.5) << v;
    ++mirrored;
  }
  EXPECT_GT(mirrored, 150);
  // Depth is that of the floor.
  EXPECT_TRUE(dull.depth(camera, T_WC).same(scene.depth(camera, T_WC)));
}

TEST(SceneRenderer, AWindowIsAPartOfTheImage) {
  const World world = load_world("office_bare");
  const SceneRenderer scene(mesh_of(world));
  const PinholeCamera camera;
  const Isometry3d T_WC = camera_pose(world.start, CameraMount());
  const DepthImage depth = scene.depth(camera, T_WC);
  const PixelWindow window{37, 101, 64, 51};
  const PixelLayer layer = scene.look(camera, T_WC, window, 2);
  ASSERT_EQ(layer.depth.size(), 64U * 51U);
  for (int v = 0; v < window.height; ++v) {
    for (int u = 0; u < window.width; ++u) {
      const auto n = static_cast<std::size_t>(v * window.width + u);
      ASSERT_EQ(layer.depth[n], depth.at(window.u + u, window.v + v));
      ASSERT_GT(layer.cosine[n], 0.0f);
    }
  }
  EXPECT_THROW(scene.look(camera, T_WC, {600, 0, 64, 8}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::scene_renderer_test
