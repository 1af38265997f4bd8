// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/gazebo_world.h"
#include "adapters/formats/worlds/load_world.h"
#include "adapters/formats/worlds/mesh_file.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/scene_renderer.h"
#include "perception/odometry/rotation_between.h"
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
  const std::string wall = "<sdf version='1.6'>" + box(0, 0, 0, 100000, 90000, 1) +
                           box(0, 0, 1, 100000, 80000, 3) + "</sdf>";
  EXPECT_NE(problem(folder.write("huge.sdf", wall)).find("too many voxels"), std::string::npos);
  const std::string closet = "<sdf version='1.6'>" + box(0, 0, 0, 0.3, 0.3, 0.1) + "</sdf>";
  EXPECT_NE(problem(folder.write("small.sdf", closet)).find("no place"), std::string::npos);
  const std::string plane =
      "<sdf version='1.6'><model name='m'><link name='l'><visual name='v'><geometry><plane>"
      "<normal>1 0 0</normal><size>5 5</size></plane></geometry></visual></link></model></sdf>";
  EXPECT_NE(problem(folder.write("upright.sdf", plane)).find("nothing level"), std::string::npos);
}

std::string problem(const std::string& path, const WorldOptions& options = {}) {
  try {
    load_world(path, options);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return "";
}

/// A house of 8 x 6 m with a door to the south, on what `ground` is.
std::string house(const std::string& ground) {
  return "<sdf version='1.6'><world name='w'>" + ground + box(-4.1, 2.9, 0, 4.1, 3.1, 2) +
         box(3.9, -3.1, 0, 4.1, 3.1, 2) + box(-4.1, -3.1, 0, -3.9, 3.1, 2) +
         box(-4.1, -3.1, 0, -0.5, -2.9, 2) + box(0.5, -3.1, 0, 4.1, -2.9, 2) + "</world></sdf>";
}

TEST(MeshWorld, GroundWithoutEndCountsAsFarAsWhatStandsOnIt) {
  const test::Folder folder("mesh world outdoors");
  const std::string grounds[] = {
      box(-50, -50, -0.1, 50, 50, 0), "<include><uri>model://ground_plane</uri></include>",
      "<model name='g'><link name='l'><visual name='v'><geometry><plane><size>300 300</size>"
      "</plane></geometry></visual></link></model>"};
  for (const std::string& ground : grounds) {
    const std::string path = folder.write("house.world", house(ground));
    const World world = load_world(path);
    EXPECT_LT(world.start.position.cwiseAbs().maxCoeff(), 4.0);
    EXPECT_NE(world.left_out.text().find("the ground beyond x -4.1 to 4.1"), std::string::npos)
        << world.left_out.text();
    EXPECT_NEAR(reachable_area(world).area, 45.0, 3.0);
    // More of it, if it is asked for; a start outside is in it in any case.
    WorldOptions options;
    options.ground_margin = 5.0;
    EXPECT_NEAR(reachable_area(load_world(path, options)).area, 18.2 * 16.2 - 5.0, 12.0);
    options = {};
    options.start = Pose{{0, -12, 0}, 0};
    EXPECT_NO_THROW(load_world(path, options));
  }
  // A yard that is not much larger than what stands in it is a yard; so is a large hall.
  const World yard = load_world(folder.write("yard.world", house(box(-8, -8, -0.1, 8, 8, 0))));
  EXPECT_TRUE(yard.left_out.empty());
  EXPECT_GT(reachable_area(yard).area, 150.0);
  // Ground alone.
  const World alone = load_world(folder.write(
      "alone.world", "<sdf version='1.6'><world name='w'>" + grounds[1] + "</world></sdf>"));
  EXPECT_NEAR(reachable_area(alone).area, 400.0, 20.0);
}

TEST(MeshWorld, TheStoreyThatIsAskedFor) {
  const test::Folder folder("mesh world storeys");
  const auto storey = [](double z, double wall) {
    return box(-4, -3, z - 0.2, 4, 3, z) + box(-4, -3, z, -3.9, 3, z + 2.5) +
           box(3.9, -3, z, 4, 3, z + 2.5) + box(-4, -3, z, 4, -2.9, z + 2.5) +
           box(-4, 2.9, z, 4, 3, z + 2.5) + box(wall, -3, z, wall + 0.1, 3, z + 2.5);
  };
  const std::string path =
      folder.write("two.sdf", "<sdf version='1.6'><world name='w'>" + storey(0, -1) + storey(3, 2) +
                                  "</world></sdf>");
  const World low = load_world(path);
  EXPECT_NEAR(low.source_floor_height, 0.0, 1e-3);
  EXPECT_NEAR(low.floor_share, 0.5, 0.1);
  WorldOptions options;
  for (const double asked : {3.0, 3.3, 2.7}) {
    options.floor = asked;
    const World high = load_world(path, options);
    EXPECT_NEAR(high.source_floor_height, 3.0, 1e-3);
    EXPECT_NE(high.voxels.data(), low.voxels.data());
  }
  options.floor = 1.5;
  EXPECT_NE(problem(path, options)
                .find("no ground within 0.5 m of z = 1.5 m; expected one of the "
                      "heights 0, 3"),
            std::string::npos)
      << problem(path, options);
}

TEST(MeshWorld, AFloorOnAPlaneWithoutEndCanBeAskedFor) {
  const test::Folder folder("mesh world plane");
  std::string text = room();
  text.insert(text.find("<model"), "<include><uri>model://ground_plane</uri></include>");
  const std::string path = folder.write("plane.sdf", text);
  WorldOptions options;
  options.ground_margin = 5.0;
  EXPECT_NEAR(load_world(path, options).source_floor_height, 0.0, 1e-3);
  for (const double asked : {0.3, 0.2}) {
    options.floor = asked;
    const World world = load_world(path, options);
    EXPECT_NEAR(world.source_floor_height, 0.3, 1e-3) << asked;
    EXPECT_NEAR(reachable_area(world).area, 6.0 * 4.0 - 1.0, 3.0);
  }
}

TEST(MeshWorld, AFloorThatReachesBeyondItsWallsCountsWhole) {
  const test::Folder folder("mesh world terrace");
  std::string text = room();
  text.insert(text.find("<model"), "<include><uri>model://ground_plane</uri></include>" +
                                       box(1.0, -3.2, 0.2, 5.0, -0.2, 0.3));
  WorldOptions options;
  options.floor = 0.3;
  const World world = load_world(folder.write("terrace.sdf", text), options);
  EXPECT_NEAR(world.source_floor_height, 0.3, 1e-3);
  const Eigen::Vector3i terrace = world.voxels.voxel({3.0, -3.0, -0.01});
  EXPECT_EQ(world.voxels.state(terrace.x(), terrace.y(), terrace.z()), CellState::kOccupied);
}

TEST(MeshWorld, GroundThatIsNotFlatIsRefused) {
  const test::Folder folder("mesh world hill");
  // A hill 1.5 m high over 12 m; a ramp; steps of 20 cm.
  const auto terrain = [&](const char* name, auto height) {
    std::string obj;
    constexpr int kSide = 40;
    for (int j = 0; j <= kSide; ++j) {
      for (int i = 0; i <= kSide; ++i) {
        const double x = 0.3 * i, y = 0.3 * j;
        obj += "v " + std::to_string(x) + " " + std::to_string(height(x, y)) + " " +
               std::to_string(-y) + "\n";
      }
    }
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const int a = j * (kSide + 1) + i + 1, b = a + kSide + 1;
        obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " +
               std::to_string(b + 1) + " " + std::to_string(b) + "\n";
      }
    }
    return folder.write(name, obj);
  };
  const std::string hills[] = {
      terrain("hill.obj",
              [](double x, double y) { return 0.75 * (std::sin(0.5 * x) + std::cos(0.5 * y)); }),
      terrain("ramp.obj", [](double x, double) { return 0.15 * x; }),
      terrain("steps.obj", [](double x, double) { return 0.2 * std::floor(x / 1.5); })};
  for (const std::string& path : hills) {
    EXPECT_NE(problem(path).find("the ground is not flat"), std::string::npos) << path;
  }
  // Asked for, it is explored as far as it is level.
  WorldOptions options;
  options.floor = 0.4;
  const World steps = load_world(hills[2], options);
  EXPECT_NEAR(steps.source_floor_height, 0.4, 1e-3);
  EXPECT_LT(steps.floor_share, 0.3);
  EXPECT_EQ(problem(terrain("even.obj", [](double, double) { return 0.0; })), "");
}

TEST(MeshWorld, VerticesFarAwayAreRefused) {
  const test::Folder folder("mesh world far");
  for (const std::string height : {"1e30", "-1e30", "3e38"}) {
    const std::string floor = "v -2 " + height + " -2\nv 2 " + height + " -2\nv 2 " + height +
                              " 2\nv -2 " + height + " 2\nf 1 4 3 2\n";
    EXPECT_NE(problem(folder.write("far.obj", floor)).find("within 100 km"), std::string::npos);
  }
}

TEST(MeshWorld, VoxelsHaveTheSizeThatIsAskedFor) {
  const test::Folder folder("mesh world size");
  WorldOptions options;
  options.voxel_size = 0.1;
  EXPECT_DOUBLE_EQ(load_world(folder.write("room.world", room()), options).voxels.resolution(),
                   0.1);
}

/// Files as people have them, each with what went wrong with it once: what they give now.
TEST(MeshWorld, FilesFromTheField) {
  const std::filesystem::path cases = std::string(PROSPECT_SHARED_DATA) + "/fieldcases";
  if (!std::filesystem::exists(cases)) GTEST_SKIP() << cases << " is absent";
  struct Case {
    const char* file;
    std::optional<Eigen::Vector2d> start;
    double area;       ///< [m^2] reachable; 0: it is refused
    const char* says;  ///< when it is refused, or what is left out
  };
  const std::optional<Eigen::Vector2d> none, corner = Eigen::Vector2d(-3, -2);
  const Case all[] = {
      {"dae_color_space/plain.dae", none, 46.6, ""},
      {"dae_color_space/space.dae", none, 46.6, ""},
      {"endless_outdoors/house_outdoors.world", none, 45, "the ground beyond"},
      {"endless_outdoors/house_outdoors.world", Eigen::Vector2d(-2, 0), 45, "the ground beyond"},
      {"gazebo_pose_degrees/degrees.world", Eigen::Vector2d(0, 1), 0, "m of room"},
      {"gazebo_pose_degrees/rad.world", Eigen::Vector2d(0, 1), 0, "m of room"},
      {"gazebo_shapes/sphere.world", none, 45, ""},
      {"gazebo_shapes/polyline.world", none, 45, ""},
      {"gazebo_shapes/capsule.sdf", none, 45, ""},
      {"gazebo_stl/stl.world", none, 45, ""},
      {"gazebo_submesh/submesh.world", corner, 44, ""},
      {"gazebo_sun_and_ground/sun.world", none, 45, "1 sun"},
      {"gazebo_sun_and_ground/fuelsun.sdf", none, 45, "1 sun"},
      {"gltf_meshopt/meshopt.glb", none, 0, "EXT_meshopt_compression"},
      {"gltf_quantized/float.glb", corner, 43.5, ""},
      {"gltf_quantized/quantized.glb", corner, 0, "KHR_mesh_quantization"},
      {"gltf_quantized/quantized_norm.glb", corner, 0, "KHR_mesh_quantization"},
      {"map_extra_key/map.yaml", none, 32.3, "key 'map_type'"},
      {"map_image_formats/ascii.yaml", none, 32.3, ""},
      {"map_image_formats/bmp.yaml", none, 32.3, ""},
      {"map_other_image_taken/office_floor2.yaml", none, 0, "office_floor2.yaml:1: image"},
      {"map_raw_mode/raw.yaml", none, 32.3, ""},
      {"map_yaml_spellings/json.yaml", none, 32.3, ""},
      {"map_yaml_spellings/negate_true.yaml", none, 32.3, ""},
      {"map_yaml_spellings/quoted.yaml", none, 32.3, ""},
      {"obj_missing_texture/tex_gone.obj", corner, 43.5, "'textures/Brick_01.png' (absent)"},
      {"obj_missing_texture/tex_ok.obj", corner, 43.5, ""},
      {"octree_color/color.bt", none, 46, ""},
      {"octree_stray_voxel/stray_far.bt", none, 46, "1 voxel up to"}};
  for (const Case& c : all) {
    SCOPED_TRACE(c.file);
    const std::string path = (cases / c.file).string();
    WorldOptions options;
    if (c.start) options.start = Pose{{c.start->x(), c.start->y(), 0}, 0};
    if (c.area == 0.0) {
      EXPECT_NE(problem(path, options).find(c.says), std::string::npos) << problem(path, options);
      continue;
    }
    const World world = load_world(path, options);
    EXPECT_NEAR(reachable_area(world).area, c.area, 1.5);
    if (*c.says == '\0') {
      EXPECT_EQ(world.left_out.text(), "");
    } else {
      EXPECT_NE(world.left_out.text().find(c.says), std::string::npos) << world.left_out.text();
    }
  }
}

TEST(MeshWorld, WhatLiesOnItsSideIsToldAndSetUpright) {
  const test::Folder folder("mesh on its side");
  // The room of 8 x 6 x 2 m has y up in its numbers, which an .obj may mean; said to be z.
  const std::string path = folder.write("room.obj", test::room_obj(8, 6, 2));
  WorldOptions options;
  EXPECT_EQ(load_world(path, options).left_out.text().find("on its side"), std::string::npos);
  options.up = UpAxis::kZ;
  const std::string told = load_world(path, options).left_out.text();
  EXPECT_NE(told.find("it seems to lie on its side; of a mesh --up y"), std::string::npos) << told;
  options.up = UpAxis::kY;
  EXPECT_EQ(load_world(path, options).left_out.text().find("on its side"), std::string::npos);
  EXPECT_NE(problem(folder.write("room.world", room()), options).find("expected no --up"),
            std::string::npos);

  const std::filesystem::path mazes = std::string(PROSPECT_SHARED_DATA) + "/worlds3d";
  if (!std::filesystem::exists(mazes)) GTEST_SKIP() << mazes << " is absent";
  const std::string maze = (mazes / "octa_maze.stl").string();
  EXPECT_NE(load_world(maze).left_out.text().find("--up y"), std::string::npos);
  const World upright = load_world(maze, options);
  EXPECT_EQ(upright.left_out.text(), "");
  EXPECT_NEAR(reachable_area(upright).area, 888.0, 15.0);
}

TEST(MeshWorld, GroundCountsWhereTheTaskLeads) {
  const test::Folder folder("mesh places");
  const std::string path = folder.write(
      "field.world", "<sdf version='1.6'><world name='w'>" + box(-50, -50, -0.1, 50, 50, 0.0) +
                         box(-1, -1, 0, 1, 1, 1) + box(-3, -3, 0, -2, -2, 1) + "</world></sdf>");
  WorldOptions options;
  const auto holds = [&](double x, double y) {
    const World world = load_world(path, options);
    return world.voxels.frame().contains(world.voxels.frame().cell(x, y));
  };
  EXPECT_FALSE(holds(0, 15));
  options.places = {{0, 15}, {0, 500}};  // one beyond all ground
  EXPECT_TRUE(holds(0, 15));
  EXPECT_FALSE(holds(0, 40));
}

TEST(MeshWorld, HostileFilesFromTheField) {
  const std::filesystem::path crashes = std::string(PROSPECT_SHARED_DATA) + "/crashes";
  if (!std::filesystem::exists(crashes)) GTEST_SKIP() << crashes << " is absent";
  for (const char* file : {"dae_12GB.dae", "gltf_20000_nested_nodes.gltf", "sdf_bomb/m0.sdf",
                           "obj_floor_at_1e30.obj"}) {
    EXPECT_NE(problem((crashes / file).string()), "") << file;
  }
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
