// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/gazebo_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "adapters/formats/files/input_error.h"
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

TEST(GazeboWorld, ACommentMayComeBeforeTheDeclaration) {
  const test::Folder folder("gazebo comment");
  const std::string whole =
      sdf("<world name='w'><model name='m'>" + visual(box("1 1 1")) + "</model></world>");
  const TexturedMesh mesh =
      read_gazebo_world(folder.write("a.world", "<!-- Usage:\n none -->\n" + whole));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  // Lines are still those of the file.
  const std::string torn = folder.write("b.world", "<!-- -->\n" + whole.substr(0, 60) + "<");
  EXPECT_NE(problem(torn).find("b.world:4: no whole XML"), std::string::npos) << problem(torn);
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
  says("<robot/>", "its root is 'robot', a URDF");
  says("<html/>", "its root is 'html'");
  says(sdf("<world name='w'/>"), "nothing to see");
  says(sdf("<world name='w'><include><uri>model://ghost</uri></include></world>"),
       "nothing to see without model 'ghost' (absent)");
  says(sdf("<world name='w'><xacro:wall length='2'/></world>"), "w.world:3: <xacro:wall>");
  says(sdf("<model name='m'><link name='l'><collision name='c'><geometry><box/></geometry>"
           "</collision></link></model>"),
       "nothing to see without 1 box collision");
  says(sdf("<model name='m'><pose>1 2 3</pose></model>"), "expected 6 numbers");
  says(sdf("<model name='m'><pose>1 2 3 0 0 nan</pose></model>"), "expected 6 numbers");
  says(sdf("<model name='m'><pose relative_to='x'>1 2 3 0 0 0</pose></model>"), "relative to 'x'");
  says(sdf("<model name='m'>" + visual("<sphere><radius>-1</radius></sphere>") + "</model>"),
       "a negative <radius>");
  says(sdf("<model name='m'>" +
           visual("<polyline><point>0 0</point><height>1</height></polyline>") + "</model>"),
       "a <polyline> of 1 points");
  says(sdf("<world name='w'><population name='p'/></world>"), "a <population>");
  says(sdf("<model name='m'><pose rotation_format='matrix'>1 2 3 0 0 0</pose></model>"),
       "rotation_format 'matrix'");
  says(sdf("<model name='m' placement_frame='x'/>"), "relative to 'x'");
  says(sdf("<model name='m'><frame name='a'><pose relative_to='b'/></frame><frame name='b'><pose "
           "relative_to='a'/></frame><link name='l'><pose relative_to='a'/></link></model>"),
       "relative to each other");
  folder.write("ring/model.sdf",
               sdf("<model name='m'><include><uri>model://ring</uri></include></model>"));
  says(sdf("<world name='w'><include><uri>model://ring</uri></include></world>"),
       "include each other");
}

/// The bounds of what a link shows, a box of 2 x 1 x 1 m.
Eigen::AlignedBox3f shown(const test::Folder& folder, const std::string& content) {
  return bounds(read_gazebo_world(folder.write("shown.world", sdf(content))));
}

void expect_box(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& low,
                const Eigen::Vector3f& high) {
  EXPECT_LT((box.min() - low).norm(), 1e-4) << box.min().transpose();
  EXPECT_LT((box.max() - high).norm(), 1e-4) << box.max().transpose();
}

TEST(GazeboWorld, AnglesAreInTheUnitThatThePoseNames) {
  const test::Folder folder("gazebo degrees");
  const std::string of_box = visual(box("2 1 1"));
  const auto with = [&](const std::string& pose) {
    return shown(folder, "<world name='w'><model name='m'>" + pose + of_box + "</model></world>");
  };
  const Eigen::Vector3f low(4.5f, -1, -0.5f), high(5.5f, 1, 0.5f);
  expect_box(with("<pose degrees='true'>5 0 0 0 0 90</pose>"), low, high);
  expect_box(with("<pose degrees='1'>5 0 0 0 0 -90</pose>"), low, high);
  expect_box(with("<pose degrees='false'>5 0 0 0 0 1.5707963</pose>"), low, high);
  expect_box(with("<pose rotation_format='euler_rpy' degrees='true'>5 0 0 180 0 90</pose>"), low,
             high);
  expect_box(with("<pose rotation_format='quat_xyzw'>5 0 0 0 0 0.7071068 0.7071068</pose>"), low,
             high);
}

TEST(GazeboWorld, PosesAreRelativeToTheFramesThatTheyName) {
  const test::Folder folder("gazebo frames");
  const auto in_world = [&](const std::string& content) {
    return shown(folder, "<world name='w'>" + content + "</world>");
  };
  const Eigen::Vector3f low(9, -0.5f, -0.5f), high(11, 0.5f, 0.5f);
  // To a frame of the world, to another model, to a link of another model.
  expect_box(in_world("<frame name='f'><pose>4 0 0 0 0 0</pose></frame><model name='m'><pose "
                      "relative_to='f'>6 0 0 0 0 0</pose>" +
                      visual(box("2 1 1")) + "</model>"),
             low, high);
  const std::string other =
      "<model name='o'><pose>4 0 0 0 0 0</pose><link name='k'><pose>1 0 0 0 0 0</pose></link>"
      "</model>";
  expect_box(in_world("<model name='m'><pose relative_to='o'>6 0 0 0 0 0</pose>" +
                      visual(box("2 1 1")) + "</model>" + other),
             low, high);
  expect_box(in_world("<model name='m'><pose relative_to='o::k'>5 0 0 0 0 0</pose>" +
                      visual(box("2 1 1")) + "</model>" + other),
             low, high);
  // A link to a frame that is attached to a link; a frame without a pose is its link's.
  expect_box(in_world("<model name='m'><link name='a'><pose>9 0 0 0 0 0</pose></link><frame "
                      "name='f' attached_to='a'/><link name='l'><pose relative_to='f'>1 0 0 0 0 0"
                      "</pose><visual name='v'><geometry>" +
                      box("2 1 1") + "</geometry></visual></link></model>"),
             low, high);
  // A visual to another link; a link to a joint, which is at its child.
  expect_box(in_world("<model name='m'><link name='a'><pose>9 0 0 0 0 0</pose></link><link "
                      "name='l'><pose>0 7 0 0 0 0</pose><visual name='v'><pose relative_to='a'>1 0 "
                      "0 0 0 0</pose><geometry>" +
                      box("2 1 1") + "</geometry></visual></link></model>"),
             low, high);
  expect_box(
      in_world("<model name='m'><link name='a'><pose>9 0 0 0 0 0</pose></link><joint "
               "name='j' type='fixed'><child>a</child><parent>l</parent></joint><link "
               "name='l'><pose relative_to='j'>1 0 0 0 0 0</pose><visual name='v'><geometry>" +
               box("2 1 1") + "</geometry></visual></link></model>"),
      low, high);
  // The pose of a model is that of its placement frame.
  expect_box(in_world("<model name='m' placement_frame='f'><pose>12 0 0 0 0 0</pose><frame "
                      "name='f'><pose>2 0 0 0 0 0</pose></frame>" +
                      visual(box("2 1 1")) + "</model>"),
             low, high);
  folder.write("models/thing/model.sdf",
               sdf("<model name='thing'><pose>77 0 0 0 0 0</pose><frame name='f'><pose>2 0 0 0 0 0"
                   "</pose></frame>" +
                   visual(box("2 1 1")) + "</model>"));
  expect_box(in_world("<include><uri>model://thing</uri><pose>12 0 0 0 0 0</pose><placement_frame>f"
                      "</placement_frame></include>"),
             low, high);
}

TEST(GazeboWorld, AStateMovesModelsAndLinks) {
  const test::Folder folder("gazebo state");
  const std::string two = "<model name='m'><pose>1 0 0 0 0 0</pose>" + visual(box("2 1 1")) +
                          "</model><model name='gone'>" + visual(box("50 50 50")) + "</model>";
  const auto with = [&](const std::string& state) {
    return shown(folder, "<world name='w'>" + two +
                             "<state world_name='w'><deletions><name>gone"
                             "</name></deletions>" +
                             state + "</state></world>");
  };
  const Eigen::Vector3f low(9, -0.5f, -0.5f), high(11, 0.5f, 0.5f);
  expect_box(with("<model name='m'><pose frame=''>10 0 0 0 0 0</pose><scale>1 1 1</scale></model>"),
             low, high);
  expect_box(with("<model name='m'><pose>8 0 0 0 0 0</pose><link name='l'><pose>10 0 0 0 0 0</pose>"
                  "</link></model>"),
             low, high);
  expect_box(with("<model name='not here'/><insertions><model name='n'><pose>10 0 0 0 0 0</pose>" +
                  visual(box("2 1 1")) +
                  "</model></insertions><model name='m'><pose>10 0 0 0 0 0"
                  "</pose></model>"),
             low, high);
  EXPECT_NE(problem(folder.write("s.world",
                                 sdf("<world name='w'>" + two +
                                     "<state><model name='m'><scale>2 1 1</scale></model></state>"
                                     "</world>")))
                .find("scaled in <state>"),
            std::string::npos);
}

TEST(GazeboWorld, RoundShapesAndPolylines) {
  const test::Folder folder("gazebo round");
  const auto of = [&](const std::string& shape) {
    return shown(folder, "<model name='m'>" + visual(shape) + "</model>");
  };
  expect_box(of("<sphere><radius>0.5</radius></sphere>"), {-0.5f, -0.5f, -0.5f},
             {0.5f, 0.5f, 0.5f});
  expect_box(of("<ellipsoid><radii>1 2 3</radii></ellipsoid>"), {-1, -2, -3}, {1, 2, 3});
  expect_box(of("<capsule><radius>0.2</radius><length>0.5</length></capsule>"),
             {-0.2f, -0.2f, -0.45f}, {0.2f, 0.2f, 0.45f});
  expect_box(of("<cone><radius>1</radius><length>3</length></cone>"), {-1, -1, -1.5f},
             {1, 1, 1.5f});
  const std::string points =
      "<point>0 0</point><point>2 0</point><point>2 2</point><point>1 0.5</point>";
  for (const std::string& p : {points, points + "<point>0 0</point>"}) {
    const TexturedMesh mesh = read_gazebo_world(folder.write(
        "poly.sdf",
        sdf("<model name='m'>" + visual("<polyline>" + p + "<height>3</height>" + "</polyline>") +
            "</model>")));
    expect_box(bounds(mesh), {0, 0, 0}, {2, 2, 3});
    double volume = 0.0;  // of a closed surface that faces outwards
    for (const auto& [a, b, c] : mesh.triangles) {
      volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
    }
    EXPECT_NEAR(volume, 3.0 * 1.5, 1e-4);
  }
  // Walls about a hole.
  const TexturedMesh hall = read_gazebo_world(folder.write(
      "hall.sdf",
      sdf("<model name='m'>" +
          visual(
              "<polyline><point>0 0</point><point>4 0</point><point>4 4</point><point>0 4</point>"
              "<height>2</height></polyline><polyline><point>1 1</point><point>3 1</point><point>"
              "3 3</point><point>1 3</point><height>2</height></polyline>") +
          "</model>")));
  EXPECT_EQ(hall.left_out.text(), "");
  double top = 0.0;
  for (const auto& [a, b, c] : hall.triangles) {
    const Eigen::Vector3f normal =
        0.5f * (hall.vertices[b] - hall.vertices[a]).cross(hall.vertices[c] - hall.vertices[a]);
    if (normal.z() > 0.0f) top += normal.z();
  }
  EXPECT_NEAR(top, 16.0 - 4.0, 1e-4);  // the hole is open
}

TEST(GazeboWorld, SunAndGroundPlaneNeedNotBeThere) {
  const test::Folder folder("gazebo sun");
  const std::string of_box = "<model name='m'>" + visual(box("2 1 1")) + "</model>";
  for (const char* uri : {"model://sun", "model://sun/", "model://Sun",
                          "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun",
                          "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/Sun/3"}) {
    const TexturedMesh mesh = read_gazebo_world(
        folder.write("a.world", sdf("<world name='w'><include><uri>" + std::string(uri) +
                                    "</uri></include>" + of_box + "</world>")));
    EXPECT_EQ(mesh.triangles.size(), 12u) << uri;
    EXPECT_EQ(mesh.left_out.text(), "1 sun") << uri;
  }
  for (const char* uri :
       {"model://ground_plane", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground%20Plane/2"}) {
    const TexturedMesh mesh = read_gazebo_world(folder.write(
        "a.world", sdf("<world name='w'><include><uri>" + std::string(uri) +
                       "</uri><pose>0 0 -1 0 0 0</pose></include>" + of_box + "</world>")));
    EXPECT_EQ(mesh.triangles.size(), 14u) << uri;
    expect_box(bounds(mesh), {-50, -50, -1}, {50, 50, 0.5f});
  }
  // A model of Fuel that lies here, and one of that name that is no stock model.
  folder.write("models/Office_Desk/model.sdf", sdf(of_box));
  EXPECT_EQ(read_gazebo_world(
                folder.write("b.world", sdf("<world name='w'><include><uri>https://fuel.gazebosim."
                                            "org/1.0/OpenRobotics/models/Office Desk</uri>"
                                            "</include></world>")))
                .triangles.size(),
            12u);
}

TEST(GazeboWorld, WhatIsNotThereIsLeftOutAndNamed) {
  const test::Folder folder("gazebo absent");
  folder.write("empty_folder/readme.txt", "");
  folder.write("model.fbx", "Kaydara");
  const auto included = [](const std::string& uri) {
    return "<include><uri>" + uri + "</uri><pose>1 1 0 0 0 0</pose></include>";
  };
  const auto shape = [](const std::string& of) {
    return "<model name='n'>" + visual(of) + "</model>";
  };
  const auto mesh = [&](const std::string& uri) {
    return shape("<mesh><uri>" + uri + "</uri></mesh>");
  };
  const std::string fuel = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Chair";
  const std::pair<std::string, std::string> cases[] = {
      {included("model://ghost"), "model 'ghost' (absent)"},
      {included("model://ghost") + included("model://ghost"), "model 'ghost' (absent)"},
      {included("model://empty_folder"), "model 'empty_folder' (absent)"},
      {included(fuel), "model '" + fuel + "' (absent)"},
      {included("package://robot/models/x"), "model 'package://robot/models/x' (absent)"},
      {included("file:///none/model.sdf"), "model 'file:///none/model.sdf' (absent)"},
      {mesh("none.dae"), "mesh 'none.dae' (absent)"},
      {mesh("model://ghost/meshes/a.dae"), "mesh 'ghost/meshes/a.dae' (absent)"},
      {mesh("https://x/none.dae"), "mesh 'https://x/none.dae' (absent)"},
      {mesh("model.fbx"), "mesh 'model.fbx' (of a kind that is not read)"},
      {shape("<heightmap><uri>a.png</uri></heightmap>"), "1 'heightmap' shape"},
      {shape("<image><uri>a.png</uri></image>"), "1 'image' shape"},
      {shape("<torus/>") + shape("<torus/>"), "2 'torus' shapes"},
      {shape("") + "<model name='o'><link name='l'><visual name='v'/></link></model>",
       "2 shapeless visuals"},
      {shape("<empty/>"), ""}};
  const std::string room = "<model name='m'>" + visual(box("2 1 1")) + "</model>";
  for (const auto& [content, left_out] : cases) {
    const TexturedMesh read = read_gazebo_world(
        folder.write("w.world", sdf("<world name='w'>" + room + content + "</world>")));
    EXPECT_EQ(read.triangles.size(), 12u) << content;
    EXPECT_EQ(read.left_out.text(), left_out);
  }
}

TEST(GazeboWorld, NamesOfFilesInOtherSpellings) {
  const test::Folder folder("gazebo names");
  folder.write("models/crate/model.sdf",
               sdf("<model name='crate'>" + visual(box("2 1 1")) + "</model>"));
  for (const std::string uri : {"model://crate", "model://crate/", " model://crate ",
                                "model://crate/model.sdf", "package://crate", "models/crate",
                                "./models/crate/model.sdf", "models\\crate\\model.sdf"}) {
    expect_box(shown(folder, "<world name='w'><include><uri>" + uri + "</uri></include></world>"),
               {-1, -0.5f, -0.5f}, {1, 0.5f, 0.5f});
  }
  expect_box(shown(folder, "<world name='w'><include><uri>file://" + folder.path("models/crate") +
                               "</uri></include></world>"),
             {-1, -0.5f, -0.5f}, {1, 0.5f, 0.5f});
}

/// A variable of the environment while a test runs.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// One triangle as wide as that.
std::string wide_obj(double width) {
  return "v 0 0 0\nv " + std::to_string(width) + " 0 0\nv 0 1 0\nf 1 2 3\n";
}

TEST(GazeboWorld, FilesAreSearchedForAsGazeboDoes) {
  const test::Folder folder("gazebo search");
  const Variable variable("GAZEBO_RESOURCE_PATH", folder.path("none") + ":" + folder.path("ws") +
                                                      ":" + folder.path("late"));
  folder.write("ws/models/bench/meshes/bench.obj", wide_obj(2));
  folder.write("ws/chair/chair.obj", wide_obj(3));
  folder.write("ws/media/models/lamp.obj", wide_obj(4));
  folder.write("ws/media/mat.obj", wide_obj(5));
  folder.write("late/chair/chair.obj", wide_obj(9));  // the first folder counts
  folder.write("worlds/own.obj", wide_obj(6));
  folder.write("worlds/chair/chair.obj", wide_obj(7));
  folder.write(
      "ws/models/door/model.sdf",
      sdf("<model name='m'>" +
          visual("<mesh><uri>file://models/bench/meshes/bench.obj</uri></mesh>") + "</model>"));
  const auto width = [&](const std::string& content) {
    const TexturedMesh mesh = read_gazebo_world(
        folder.write("worlds/w.world", sdf("<world name='w'>" + content + "</world>")));
    EXPECT_EQ(mesh.left_out.text(), "");
    return bounds(mesh).sizes().x();
  };
  const auto of_mesh = [&](const std::string& uri) {
    return width("<model name='m'>" + visual("<mesh><uri>" + uri + "</uri></mesh>") + "</model>");
  };
  EXPECT_EQ(of_mesh("file://models/bench/meshes/bench.obj"), 2);
  EXPECT_EQ(of_mesh("file://bench/meshes/bench.obj"), 2);  // `models` in the folder
  EXPECT_EQ(of_mesh("model://bench/meshes/bench.obj"), 2);
  EXPECT_EQ(of_mesh("bench\\meshes\\bench.obj"), 2);
  EXPECT_EQ(of_mesh("file://chair/chair.obj"), 3);  // Gazebo's folders before the world's own
  EXPECT_EQ(of_mesh("chair/chair.obj"), 7);         // a plain name: its own first
  EXPECT_EQ(of_mesh("file://lamp.obj"), 4);
  EXPECT_EQ(of_mesh("file://mat.obj"), 5);
  EXPECT_EQ(of_mesh("file://media/mat.obj"), 5);
  EXPECT_EQ(of_mesh("file://own.obj"), 6);
  EXPECT_EQ(width("<include><uri>model://door</uri></include>"), 2);
  EXPECT_EQ(width("<include><uri>file://models/door</uri></include>"), 2);
}

TEST(GazeboWorld, AMeshThatCannotBeReadIsLeftOutAndNamed) {
  const test::Folder folder("gazebo unreadable");
  folder.write("torn.dae", "<COLLADA><asset>");
  folder.write("pointer.stl", "version https://git-lfs.github.com/spec/v1\nsize 4711\n");
  folder.write("good.obj", wide_obj(3));
  const auto mesh = [&](const std::string& content) {
    return "<model name='m'>" + visual("<mesh>" + content + "</mesh>") + "</model>";
  };
  const std::string torn = mesh("<uri>torn.dae</uri>");
  const TexturedMesh read = read_gazebo_world(folder.write(
      "w.world", sdf("<world name='w'>" + torn + mesh("<uri>pointer.stl</uri>") + torn +
                     mesh("<uri>good.obj</uri><submesh><name>none</name></submesh>") +
                     mesh("<uri>good.obj</uri>") + "</world>")));
  EXPECT_EQ(read.triangles.size(), 1u);
  ASSERT_EQ(read.left_out.items().size(), 3u);
  EXPECT_NE(read.left_out.text().find("mesh 'torn.dae' (cannot be read"), std::string::npos);
  EXPECT_NE(read.left_out.text().find("mesh 'pointer.stl' (53 bytes"), std::string::npos)
      << read.left_out.text();
  EXPECT_NE(read.left_out.text().find("mesh 'good.obj' (no submesh 'none'"), std::string::npos);
  EXPECT_NE(problem(folder.write("x.world", sdf("<world name='w'>" + torn + "</world>")))
                .find("nothing to see without mesh 'torn.dae'"),
            std::string::npos);
}

TEST(GazeboWorld, TellsWhatItDoesNotRead) {
  const test::Folder folder("gazebo left out");
  const TexturedMesh mesh = read_gazebo_world(folder.write(
      "a.world",
      sdf("<world name='w'><physics type='ode'/><scene/><gravity>0 0 -9.8</gravity><light "
          "name='a'/><light name='b'/><plugin name='p' filename='f'/><actor name='c'/><model "
          "name='m'><static>1</static>" +
          visual(box("2 1 1")) +
          "<link name='k'><collision name='c'><geometry><sphere><radius>1</radius></sphere>"
          "</geometry></collision><collision name='d'><geometry><sphere><radius>1</radius></sphere>"
          "</geometry></collision><sensor name='s'/><inertial/></link></model><teapot/></world>")));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.left_out.text(),
            "2 lights, 1 plugin, 1 actor, 1 'teapot' element, 2 sphere collisions, 1 sensor");
}

TEST(GazeboWorld, AManifestNamesTheModelsFile) {
  const test::Folder folder("gazebo manifest");
  folder.write("models/crate/model.config",
               "<model><name>crate</name><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>new.sdf"
               "</sdf></model>");
  folder.write("models/crate/old.sdf", "<sdf/>");
  folder.write("models/crate/new.sdf",
               sdf("<model name='crate'>" + visual(box("2 1 1")) + "</model>"));
  expect_box(shown(folder, "<world name='w'><include><uri>model://crate</uri></include></world>"),
             {-1, -0.5f, -0.5f}, {1, 0.5f, 0.5f});
}

TEST(GazeboWorld, SubmeshesAreKeptApart) {
  const test::Folder folder("gazebo submesh");
  folder.write("two.obj",
               "o shelf\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 2\nf 1 2 3\nf 1 3 4\n"
               "o wall\nv 5 0 0\nv 9 0 0\nv 9 4 2\nf 5 6 7\n");
  const auto of = [&](const std::string& submesh) {
    return "<model name='m'>" + visual("<mesh><uri>two.obj</uri>" + submesh + "</mesh>") +
           "</model>";
  };
  expect_box(shown(folder, of("")), {0, 0, 0}, {9, 4, 2});
  expect_box(shown(folder, of("<submesh><name>shelf</name></submesh>")), {0, 0, 0}, {1, 1, 2});
  expect_box(shown(folder, of("<submesh><name>wall</name></submesh>")), {5, 0, 0}, {9, 4, 2});
  expect_box(shown(folder, of("<submesh><name>wall</name><center>true</center></submesh>")),
             {-2, -2, -1}, {2, 2, 1});
  // Both of one file, and one that is not there.
  expect_box(shown(folder, of("<submesh><name>shelf</name></submesh>") +
                               of("<submesh><name>wall</name></submesh>")),
             {0, 0, 0}, {9, 4, 2});
  const std::string wrong =
      problem(folder.write("w.world", sdf(of("<submesh><name>door</name></submesh>"))));
  EXPECT_NE(wrong.find("no submesh 'door'; expected one of: 'shelf', 'wall'"), std::string::npos)
      << wrong;
}

TEST(GazeboWorld, ABrokenIncludeIsLeftOutAndNamed) {
  const test::Folder folder("gazebo broken include");
  const auto model = [](const std::string& content) {
    return sdf("<model name='m'>" + content + "</model>");
  };
  const std::string good = visual(box("1 1 1"));
  const struct {
    std::string content, why;
  } rows[] = {
      {"<sdf><model>", "thing.sdf:1: no whole XML"},
      {"", "no whole XML"},
      {"<robot name='r'/>", "its root is 'robot', a URDF"},
      {sdf("<nothing/>"), "holds no model; expected one"},
      {model("<pose>1 2</pose>" + good), "expected 6 numbers"},
      {model(good + visual(box("1 x 1"))), "thing.sdf:3: <size> holds '1 x 1'"},
      {model(good + visual("<sphere><radius>-1</radius></sphere>")), "a negative <radius>"},
      {model(good + "<link name='k'><pose relative_to='gone'/></link>"), "relative to 'gone'"},
      {model("<include><uri>broken.sdf</uri></include>" + good), "broken.sdf:1: no whole XML"}};
  folder.write("broken.sdf", "<sdf>");
  for (const auto& row : rows) {
    SCOPED_TRACE(row.why);
    folder.write("thing.sdf", row.content);
    const TexturedMesh mesh = read_gazebo_world(folder.write(
        "a.world", sdf("<world name='w'><include><uri>thing.sdf</uri></include><model name='n'>" +
                       visual(box("2 2 2")) + "</model></world>")));
    // What the world holds itself, and of a part that is broken the rest.
    const bool nested = row.why.starts_with("broken");
    EXPECT_EQ(mesh.triangles.size(), nested ? 24u : 12u);
    EXPECT_EQ(mesh.vertices.size(), mesh.uv.size());
    EXPECT_EQ(mesh.triangles.size(), mesh.material.size());
    EXPECT_NE(mesh.left_out.text().find(row.why), std::string::npos) << mesh.left_out.text();
  }
  // What the world says of it itself is the world's.
  folder.write("thing.sdf", model(good));
  EXPECT_NE(problem(folder.write("a.world", sdf("<world name='w'><include><uri>thing.sdf</uri>"
                                                "<pose>1 2</pose></include></world>")))
                .find("a.world:3: <pose> holds '1 2'"),
            std::string::npos);
}

TEST(GazeboWorld, IncludesOfIncludesEnd) {
  const test::Folder folder("gazebo bomb");
  constexpr int kLevels = 10;
  for (const bool models : {false, true}) {
    for (int n = 0; n < kLevels; ++n) {
      std::string includes;
      for (int k = 0; k < 8; ++k) {
        includes += "<include><uri>m" + std::to_string(n + 1) + ".sdf</uri></include>";
      }
      folder.write("m" + std::to_string(n) + ".sdf",
                   sdf(models ? "<model name='m'>" + includes + "</model>" : includes));
    }
    folder.write("m10.sdf", sdf("<model name='m'>" + visual(box("1 1 1")) + "</model>"));
    EXPECT_NE(problem(folder.path("m0.sdf")).find("20000 models"), std::string::npos);
  }
}

}  // namespace
}  // namespace prospect::gazebo_world_test
