#include "adapters/worlds/mesh_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "adapters/config/input_error.h"
#include "adapters/simulator/depth_camera.h"
#include "adapters/simulator/scene_renderer.h"
#include "adapters/worlds/gazebo_world.h"
#include "adapters/worlds/load_world.h"
#include "adapters/worlds/mesh_file.h"
#include "adapters/worlds/reachable_area.h"
#include "perception/rotation_between.h"
#include "tests/adapters/mesh_files.h"

namespace prospect::mesh_world_test {
namespace {

std::string box(double x0, double y0, double z0, double x1, double y1, double z1) {
  char text[400];
  std::snprintf(text, sizeof text,
                "<model name='b'><pose>%g %g %g 0 0 0</pose><link name='l'><visual name='v'>"
                "<geometry><box><size>%g %g %g</size></box></geometry></visual></link></model>",
                0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1), x1 - x0, y1 - y0, z1 - z0);
  return text;
}

/// A room of 6 x 4 m with walls, a floor 0.3 m above the file's z = 0 and a hollow crate.
std::string room() {
  return "<sdf version='1.6'><world name='w'>" + box(-0.2, -0.2, 0.2, 6.2, 4.2, 0.3) +
         box(-0.2, -0.2, 0.2, 0.0, 4.2, 3.0) + box(6.0, -0.2, 0.2, 6.2, 4.2, 3.0) +
         box(-0.2, -0.2, 0.2, 6.2, 0.0, 3.0) + box(-0.2, 4.0, 0.2, 6.2, 4.2, 3.0) +
         box(4.0, 1.0, 0.3, 5.0, 2.0, 1.3) + "</world></sdf>";
}

TEST(MeshWorld, VoxelisesARoom) {
  const test::Folder folder("mesh world");
  const World world = load_world(folder.write("room.world", room()));
  EXPECT_EQ(world.name, "room");
  ASSERT_NE(world.mesh, nullptr);
  EXPECT_NEAR(world.source_floor_height, 0.3, 1e-6);
  EXPECT_DOUBLE_EQ(world.voxels.resolution(), 0.05);
  const auto at = [&](double x, double y, double z) {
    const Eigen::Vector3i v = world.voxels.voxel({x, y, z});
    return world.voxels.state(v[0], v[1], v[2]);
  };
  EXPECT_EQ(at(2.0, 2.0, 0.01), CellState::kFree);
  EXPECT_EQ(at(2.0, 2.0, -0.01), CellState::kOccupied);
  EXPECT_EQ(at(2.0, 2.0, 2.4), CellState::kFree);
  EXPECT_EQ(at(4.5, 1.025, 0.5), CellState::kOccupied);  // the crate's side
  EXPECT_EQ(at(4.5, 0.975, 0.5), CellState::kFree);
  EXPECT_EQ(at(4.5, 1.5, 0.5), CellState::kUnknown);  // inside the crate
  EXPECT_EQ(at(4.5, 1.5, 0.9), CellState::kUnknown);
  EXPECT_EQ(at(4.5, 1.5, 1.2), CellState::kFree);      // above it
  EXPECT_EQ(at(-0.1, 2.0, 0.5), CellState::kUnknown);  // inside a wall
  const GridFrame& f = world.voxels.frame();
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      if (world.voxels.state(i, j, 0) != CellState::kFree) continue;
      ASSERT_EQ(world.voxels.state(i, j, -1), CellState::kOccupied);
      const Eigen::Vector2d c = f.center({i, j});
      ASSERT_TRUE(c.x() > 0 && c.x() < 6 && c.y() > 0 && c.y() < 4) << c.transpose();
    }
  }
  // 24 m^2 less the crate and the voxels that the walls touch.
  EXPECT_NEAR(reachable_area(world).area, 24.0 - 1.0, 1.2);
  const Grid<std::uint8_t> standing = standing_columns(world.voxels, BodySlice{});
  EXPECT_EQ(standing.get(f.cell(world.start.position.x(), world.start.position.y()), 0), 1);
}

TEST(MeshWorld, VoxelsAreThoseThatTheTriangleTouches) {
  // A tilted triangle against samples of it: each lies in an occupied voxel, and each occupied
  // voxel is near one.
  TexturedMesh mesh;
  mesh.vertices = {{0, 0, 0},
                   {3, 0, 0},
                   {3, 3, 0},
                   {0, 3, 0},
                   {0.613f, 0.407f, 0.113f},
                   {2.211f, 1.009f, 1.307f},
                   {1.103f, 2.609f, 0.771f}};
  mesh.uv.assign(7, {0, 0});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  mesh.material = {0, 0, 0};
  mesh.textures = {Image(1, 1, 128)};
  const World world = world_from_mesh(mesh, "tilted");
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& f = voxels.frame();
  std::vector<int> samples(voxels.data().size(), 0);
  constexpr int n = 1500;
  for (int a = 0; a <= n; ++a) {
    for (int b = 0; a + b <= n; ++b) {
      const Eigen::Vector3f p =
          (a * mesh.vertices[4] + b * mesh.vertices[5] + (n - a - b) * mesh.vertices[6]) / float(n);
      const Eigen::Vector3i v = voxels.voxel(p.cast<double>());
      ASSERT_EQ(voxels.state(v[0], v[1], v[2]), CellState::kOccupied);
      ++samples[voxels.index(v[0], v[1], v[2])];
    }
  }
  int occupied = 0, unsampled = 0;
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = 0; k < voxels.depth() - 1; ++k) {
        if (voxels.state(i, j, k) != CellState::kOccupied) continue;
        ++occupied;
        unsampled += samples[voxels.index(i, j, k)] == 0;
      }
    }
  }
  EXPECT_GT(occupied, 1000);
  EXPECT_LT(unsampled, occupied / 100);  // touched by less than 1.5 mm of it
}

TEST(MeshWorld, RefusesWhatIsNoBuilding) {
  const test::Folder folder("mesh world wrong");
  const auto problem = [](const std::string& path) {
    try {
      load_world(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string wall = "<sdf version='1.6'>" + box(0, 0, 0, 100000, 90000, 1) + "</sdf>";
  EXPECT_NE(problem(folder.write("huge.sdf", wall)).find("too many voxels"), std::string::npos);
  const std::string closet = "<sdf version='1.6'>" + box(0, 0, 0, 0.3, 0.3, 0.1) + "</sdf>";
  EXPECT_NE(problem(folder.write("small.sdf", closet)).find("no place"), std::string::npos);
  const std::string plane =
      "<sdf version='1.6'><model name='m'><link name='l'><visual name='v'><geometry><plane>"
      "<normal>1 0 0</normal><size>5 5</size></plane></geometry></visual></link></model></sdf>";
  EXPECT_NE(problem(folder.write("upright.sdf", plane)).find("nothing level"), std::string::npos);
}

TEST(MeshWorld, SmallWarehouse) {
  const std::string path =
      std::string(PROSPECT_SHARED_DATA) + "/mesh/aws_small_warehouse/worlds/small_warehouse.world";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const World world = load_world(path);
  const double area = reachable_area(world).area;
  std::printf("warehouse: %zu triangles, %.1f m^2 reachable, start (%.2f, %.2f)\n",
              world.mesh->triangles.size(), area, world.start.position.x(),
              world.start.position.y());
  EXPECT_GT(area, 100.0);  // the hall has 14 x 21 m
  EXPECT_LT(area, 300.0);
  std::size_t textured = 0;
  for (const std::uint32_t material : world.mesh->material) {
    textured += world.mesh->textures[material].width > 1;
  }
  EXPECT_EQ(textured, world.mesh->material.size());

  // What the depth camera measures in the voxels is what the mesh shows, but for the size of a
  // voxel: the mesh lies within the voxels that it touches.
  DepthCameraOptions exact;
  exact.noise_constant = exact.noise_quadratic = exact.dropout = 0.0;
  exact.footprint.min_range = 0.0;
  const CameraMount mount;
  DepthCamera voxels(world, exact, mount, 1);
  const SceneRenderer scene(*world.mesh);
  int rays = 0, close = 0, nearer = 0;
  for (int n = 0; n < 8; ++n) {
    Pose pose = world.start;
    pose.yaw = 0.785 * n;
    const DepthScan scan = voxels.sense(pose);
    for (const Eigen::Vector3d& hit : scan.hits) {
      const Eigen::Vector3d ray = mount.T_BC.linear().transpose() * (hit - scan.origin);
      // The pixel of a camera that looks straight along the ray.
      Eigen::Isometry3d T_WC = camera_pose(pose, mount);
      T_WC.linear() =
          T_WC.linear() * rotation_between(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix();
      const double z = scene.depth({1.0, 1.0, 0.0, 0.0, 1.0, 1.0}, T_WC).at(0, 0);
      const double difference = z - ray.norm();
      ++rays;
      nearer += difference < -0.03;  // the mesh before the voxels: below the floor's tolerance only
      close += difference < 0.15;
    }
  }
  std::printf("%d rays: %.1f %% end within 0.15 m behind the voxel's face, %d before it\n", rays,
              100.0 * close / rays, nearer);
  EXPECT_GT(rays, 10000);
  EXPECT_GT(close, 0.9 * rays);
  EXPECT_LT(nearer, rays / 200);
}

}  // namespace
}  // namespace prospect::mesh_world_test
