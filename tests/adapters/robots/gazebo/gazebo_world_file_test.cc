// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_world_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/worlds/gazebo_world.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "models/unicycle.h"
#include "tests/adapters/box_room.h"

namespace prospect::gazebo_world_file_test {
namespace {

using ::testing::HasSubstr;

RobotDescription robot() {
  RobotDescription robot;
  robot.model = std::make_shared<Unicycle>();
  return robot;
}

struct Exported {
  Exported() : world(test::box_room(2.0, 1.5, 1.2)) {
    test::fill(world, {0.2, 0.2, 0.0}, {0.5, 0.4, 0.6});
    mesh = world_mesh(world, FeatureField(world, {}), {.texel = 0.02});
    files = gazebo_world_files(world, mesh, robot(), {}, "box");
  }
  const std::string& file(const std::string& name) const {
    for (const auto& [known, content] : files) {
      if (known == name) return content;
    }
    throw std::out_of_range(name);
  }
  World world;
  TexturedMesh mesh;
  std::vector<std::pair<std::string, std::string>> files;
};

TEST(GazeboWorldFile, FacesLookIntoFreeSpace) {
  const Exported e;
  std::istringstream obj(e.file("box.obj"));
  std::vector<Eigen::Vector3d> vertices, normals;
  std::size_t faces = 0;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    Eigen::Vector3d p;
    if (word == "v" && words >> p.x() >> p.y() >> p.z()) vertices.push_back(p);
    if (word == "vn" && words >> p.x() >> p.y() >> p.z()) normals.push_back(p);
    if (word != "f") continue;
    ++faces;
    std::vector<Eigen::Vector3d> corner;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::string index; words >> index;) {
      corner.push_back(vertices.at(std::stoul(index) - 1));
      normal = normals.at(std::stoul(index.substr(index.rfind('/') + 1)) - 1);
    }
    ASSERT_EQ(corner.size(), 3u);
    const Eigen::Vector3d across = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    EXPECT_NEAR(across.normalized().dot(normal), 1.0, 1e-6);
    const Eigen::Vector3d before = (corner[0] + corner[1] + corner[2]) / 3.0 + 0.05 * normal;
    const Eigen::Vector3i v = (before / 0.1).array().floor().cast<int>();
    EXPECT_EQ(e.world.voxels.state(v.x(), v.y(), v.z()), CellState::kFree);
  }
  EXPECT_EQ(faces, e.mesh.triangles.size());
}

TEST(GazeboWorldFile, NamesWhatTheAdapterLooksFor) {
  const Exported e;
  const std::string& sdf = e.file("box.sdf");
  EXPECT_THAT(sdf, HasSubstr("<uri>box.obj</uri>"));
  EXPECT_THAT(sdf, HasSubstr("<model name=\"robot\">\n<pose>1 0.75 0 0 0 0</pose>"));
  EXPECT_THAT(sdf, HasSubstr("<link name=\"left_wheel\"><pose>0 0.16 0.08"));
  EXPECT_THAT(sdf, HasSubstr("<left_joint>left_wheel_joint</left_joint>"));
  // The default mount looks ahead from 0.45 m, the right camera is to the right.
  EXPECT_THAT(sdf, HasSubstr("<update_rate>15</update_rate><pose>0 0 0.45 0 0 0</pose>"));
  EXPECT_THAT(sdf, HasSubstr("<camera name=\"right\"><pose>0 -0.12 0 0 0 0</pose>"));
  EXPECT_THAT(e.file("box.mtl"), HasSubstr("map_Kd box_0.png"));
  EXPECT_THAT(e.file("box_0.png"), HasSubstr("PNG"));
}

TEST(GazeboWorldFile, ACameraLooksWhereItsMountSays) {
  RobotDescription tilted = robot();
  tilted.stereo_mount.T_BC = CameraMount::forward_facing({0.1, 0.06, 0.3}, 0.5, 0.2);
  const Exported e;
  const auto files = gazebo_world_files(e.world, e.mesh, tilted, {}, "box");
  const std::string& sdf = files.back().second;
  const std::size_t at = sdf.find("<pose>", sdf.find("multicamera"));
  std::istringstream words(sdf.substr(at + 6, 200));
  double x, y, z, roll, pitch, yaw;
  ASSERT_TRUE(words >> x >> y >> z >> roll >> pitch >> yaw);
  EXPECT_NEAR(x, 0.1, 1e-9);
  EXPECT_NEAR(y, 0.06, 1e-9);
  EXPECT_NEAR(roll, 0.0, 1e-9);
  EXPECT_NEAR(pitch, 0.2, 1e-8);  // SDF: about y, so down
  EXPECT_NEAR(yaw, 0.5, 1e-8);
}

TEST(GazeboWorldFile, BoxesStandWhereTheRobotCannot) {
  const Exported e;
  const std::string& sdf = e.file("box.sdf");
  double area = 0.0;
  for (std::size_t at = sdf.find("wall_"); at != std::string::npos;
       at = sdf.find("wall_", at + 1)) {
    std::istringstream pose(sdf.substr(sdf.find("<pose>", at) + 6, 60));
    std::istringstream size(sdf.substr(sdf.find("<size>", at) + 6, 60));
    double x, y, dx, dy, dz;
    ASSERT_TRUE(pose >> x >> y && size >> dx >> dy >> dz);
    EXPECT_EQ(dz, 1.0);
    area += dx * dy;
    for (double px = x - 0.5 * dx + 0.05; px < x + 0.5 * dx; px += 0.1) {
      for (double py = y - 0.5 * dy + 0.05; py < y + 0.5 * dy; py += 0.1) {
        EXPECT_TRUE(e.world.solid(static_cast<int>(std::floor(px / 0.1)),
                                  static_cast<int>(std::floor(py / 0.1)), 3));
      }
    }
  }
  // The walls, 2.2 x 1.7 m less the room, and the box of 0.3 x 0.2 m.
  EXPECT_NEAR(area, 2.2 * 1.7 - 2.0 * 1.5 + 0.06, 1e-6);
}

// Each has its name, its place and its view.
TEST(GazeboWorldFile, ARobotHasAllItsDepthCameras) {
  RobotDescription seeing = robot();
  DepthSensor rear{seeing.depth, {CameraMount::forward_facing({-0.1, 0.0, 0.3}, M_PI, 0.0)}};
  rear.footprint.horizontal_fov = 1.5;
  rear.footprint.vertical_fov = 1.0;
  seeing.more_depth = {rear};
  const Exported e;
  const auto files = gazebo_world_files(e.world, e.mesh, seeing, {}, "box");
  const std::string& sdf = files.back().second;
  EXPECT_THAT(sdf, HasSubstr("<sensor name=\"depth\" type=\"depth\">"));
  const std::size_t at = sdf.find("<sensor name=\"depth_1\" type=\"depth\">");
  ASSERT_NE(at, std::string::npos);
  const std::string second = sdf.substr(at, 500);
  EXPECT_THAT(second, HasSubstr("<horizontal_fov>1.5</horizontal_fov>"));
  const auto cameras = gazebo_depth_cameras(seeing, {});
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_NEAR(cameras.at(1).fx, 160.0 / std::tan(0.75), 1e-9);
  EXPECT_EQ(cameras.at(1).height, std::round(320.0 * std::tan(0.5) / std::tan(0.75)));
  EXPECT_THAT(
      second,
      HasSubstr("<height>" + std::to_string(static_cast<int>(cameras.at(1).height)) + "</height>"));
  EXPECT_THAT(second, HasSubstr("<pose>-0.1 0 0.3"));
  // A lidar is none.
  seeing.more_depth[0].footprint.vertical_fov = 0.0;
  EXPECT_THROW(gazebo_depth_cameras(seeing, {}), InputError);
}

TEST(GazeboWorldFile, RefusesWhatGazeboCannotShow) {
  const Exported e;
  RobotDescription oblong = robot();
  oblong.stereo.left.fy = 400.0;
  EXPECT_THROW(gazebo_world_files(e.world, e.mesh, oblong, {}, "box"), std::invalid_argument);
  RobotDescription hull = robot();
  hull.shape = SphereSetShape{{{}}};
  EXPECT_THROW(gazebo_world_files(e.world, e.mesh, hull, {}, "box"), std::invalid_argument);
  TexturedMesh slanted = e.mesh;
  slanted.vertices.front().z() += 0.3f;
  slanted.vertices.front().x() += 0.3f;
  slanted.vertices.front().y() += 0.3f;
  EXPECT_THROW(gazebo_world_files(e.world, slanted, robot(), {}, "box"), std::invalid_argument);
  GazeboWorldOptions still;
  still.robot.image_rate = 0.0;
  EXPECT_THROW(gazebo_world_files(e.world, e.mesh, robot(), still, "box"), std::invalid_argument);
}

TEST(GazeboWorldFile, TheRobotHasAnImuIfOneIsNamed) {
  const Exported e;
  GazeboWorldOptions options;
  const auto sdf = [&] {
    std::string all;
    for (const auto& [name, content] :
         gazebo_world_files(e.world, e.mesh, robot(), options, "box")) {
      all += content;
    }
    return all;
  };
  EXPECT_EQ(sdf().find("type=\"imu\""), std::string::npos);
  options.robot.names.imu = "gyro";
  EXPECT_NE(sdf().find("<sensor name=\"gyro\" type=\"imu\">"), std::string::npos);
}

TEST(GazeboWorldFile, OurOwnReaderFindsTheSurfacesWhereTheyAre) {
  const Exported e;
  const std::filesystem::path folder = "gazebo_world_file_test";
  std::filesystem::create_directories(folder);
  for (const auto& [name, content] : e.files) {
    std::ofstream(folder / name, std::ios::binary) << content;
  }
  const TexturedMesh read = read_gazebo_world((folder / "box.sdf").string());
  EXPECT_EQ(read.triangles.size(), e.mesh.triangles.size());
  Eigen::AlignedBox3f box, expected;
  for (const Eigen::Vector3f& v : read.vertices) box.extend(v);
  for (const Eigen::Vector3f& v : e.mesh.vertices) expected.extend(v);
  EXPECT_TRUE(box.isApprox(expected, 1e-4f));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prospect::gazebo_world_file_test
