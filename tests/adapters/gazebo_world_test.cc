#include "adapters/worlds/gazebo_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "adapters/config/input_error.h"
#include "tests/adapters/mesh_files.h"

namespace prospect::gazebo_world_test {
namespace {

Eigen::AlignedBox3f bounds(const TexturedMesh& mesh, std::size_t first = 0,
                           std::size_t last = static_cast<std::size_t>(-1)) {
  Eigen::AlignedBox3f box;
  for (std::size_t n = first; n < std::min(last, mesh.triangles.size()); ++n) {
    for (const std::uint32_t v : mesh.triangles[n]) box.extend(mesh.vertices[v]);
  }
  return box;
}

std::string visual(const std::string& shape, const std::string& pose = "") {
  return "<link name='l'><visual name='v'>" + (pose.empty() ? "" : "<pose>" + pose + "</pose>") +
         "<geometry>" + shape + "</geometry></visual></link>";
}

std::string sdf(const std::string& content) {
  return "<?xml version='1.0'?>\n<sdf version='1.6'>\n" + content + "\n</sdf>\n";
}

std::string box(const std::string& size) { return "<box><size>" + size + "</size></box>"; }

std::string problem(const std::string& path) {
  try {
    read_gazebo_world(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    return error.what();
  }
  return "";
}

TEST(GazeboWorld, PosesAreInsideEachOther) {
  const test::Folder folder("gazebo poses");
  // A box of 2 x 0.2 x 0.4 whose visual lies 1 m ahead in its link; the model is turned left by 90
  // degrees about (5, 1, 0).
  const TexturedMesh mesh = read_gazebo_world(folder.write(
      "a.world", sdf("<world name='w'><light name='sun'/><model name='m'><pose>5 1 0 0 0 "
                     "1.5707963</pose>" +
                     visual(box("2 0.2 0.4"), "1 0 0.2 0 0 0") + "</model></world>")));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_LT((bounds(mesh).min() - Eigen::Vector3f(4.9f, 1, 0)).norm(), 1e-5);
  EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(5.1f, 3, 0.4f)).norm(), 1e-5);
  // All faces outwards: the volume by the divergence theorem.
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
  }
  EXPECT_NEAR(volume, 2 * 0.2 * 0.4, 1e-4);
}

TEST(GazeboWorld, IncludesModelsWithMeshesAndScales) {
  const test::Folder folder("gazebo include");
  folder.write("models/room/meshes/room.obj", test::room_obj(4, 3, 2));
  folder.write("models/room/meshes/room.mtl", test::room_mtl());
  folder.write("models/room/materials/textures/stripes.pgm", test::two_greys_pgm());
  folder.write(
      "models/room/model.sdf",
      sdf("<model name='room'><pose>100 0 0 0 0 0</pose>" +
          visual("<mesh><uri>model://room/meshes/room.obj</uri><scale>1 1 -1</scale></mesh>") +
          "</model>"));
  const std::string path = folder.write(
      "worlds/two.world", sdf("<world name='w'>"
                              "<include><uri>model://room</uri><pose>10 0 0 0 0 0</pose></include>"
                              "<model name='nested'><include><uri>model://room</uri></include>"
                              "<pose frame=''>0 20 0 0 0 0</pose></model></world>"));
  const TexturedMesh mesh = read_gazebo_world(path);
  ASSERT_EQ(mesh.triangles.size(), 24u);
  // The obj's own numbers with z up: 4 x 2 x -3, mirrored to z >= 0. The pose of the include
  // replaces the model's; without one the model's counts.
  EXPECT_LT((bounds(mesh, 0, 12).min() - Eigen::Vector3f(10, 0, 0)).norm(), 1e-4);
  EXPECT_LT((bounds(mesh, 0, 12).max() - Eigen::Vector3f(14, 2, 3)).norm(), 1e-4);
  EXPECT_LT((bounds(mesh, 12).min() - Eigen::Vector3f(100, 20, 0)).norm(), 1e-4);
  EXPECT_EQ(mesh.material[0], mesh.material[23]);  // one texture, however often it is shown
  EXPECT_EQ(mesh.textures[mesh.material[0]].width, 2);
}

TEST(GazeboWorld, PlainShapes) {
  const test::Folder folder("gazebo shapes");
  const std::string grey = "<material><diffuse>0.2 0.2 0.2 1</diffuse></material>";
  const TexturedMesh mesh = read_gazebo_world(folder.write(
      "a.sdf", sdf("<model name='m'><link name='l'><visual name='a'><geometry><cylinder><radius>0.5"
                   "</radius><length>2</length></cylinder></geometry>" +
                   grey +
                   "</visual><visual name='b'><geometry><plane><normal>0 0 1</normal><size>6 4"
                   "</size></plane></geometry></visual></link></model>")));
  EXPECT_LT((bounds(mesh).min() - Eigen::Vector3f(-3, -2, -1)).norm(), 1e-5);
  EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(3, 2, 1)).norm(), 1e-5);
  EXPECT_EQ(mesh.textures[mesh.material.front()].pixels[0], 51);
  EXPECT_EQ(mesh.textures[mesh.material.back()].pixels[0], 180);
}

TEST(GazeboWorld, SaysWhereAndWhat) {
  const test::Folder folder("gazebo wrong");
  const auto says = [&](const std::string& content, const std::string& what) {
    const std::string found = problem(folder.write("w.world", content));
    EXPECT_NE(found.find(what), std::string::npos) << found;
  };
  EXPECT_NE(problem(folder.path("none.world")).find("no such file"), std::string::npos);
  says("", "no whole XML");
  says("<sdf><world>", "no whole XML");
  says("<robot/>", "no element <sdf>");
  says(sdf("<world name='w'/>"), "nothing to see");
  says(sdf("<world name='w'><include><uri>model://ghost</uri></include></world>"),
       "w.world:3: no model 'ghost'");
  says(sdf("<model name='m'><pose>1 2 3</pose></model>"), "expected 6 numbers");
  says(sdf("<model name='m'><pose>1 2 3 0 0 nan</pose></model>"), "expected 6 numbers");
  says(sdf("<model name='m'><pose relative_to='x'>1 2 3 0 0 0</pose></model>"), "relative to 'x'");
  says(sdf("<model name='m'>" + visual("<sphere><radius>1</radius></sphere>") + "</model>"),
       "the shape <sphere>");
  says(sdf("<model name='m'>" + visual("<mesh><uri>none.dae</uri></mesh>") + "</model>"),
       "no file");
  says(sdf("<model name='m'>" + visual("<mesh><uri>https://x/none.dae</uri></mesh>") + "</model>"),
       "expected model://");
  folder.write("ring/model.sdf",
               sdf("<model name='m'><include><uri>model://ring</uri></include></model>"));
  says(sdf("<world name='w'><include><uri>model://ring</uri></include></world>"),
       "include each other");
}

}  // namespace
}  // namespace prospect::gazebo_world_test
