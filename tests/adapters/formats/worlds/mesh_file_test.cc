// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/mesh_files.h"

namespace prospect::mesh_file_test {
namespace {

Eigen::AlignedBox3f bounds(const TexturedMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.vertices) box.extend(p);
  return box;
}

std::string problem(const std::string& path) {
  try {
    read_mesh_file(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1u);
    EXPECT_EQ(error.lines()[0].find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

/// One triangle (0, 0, 0), (100, 0, 0), (0, 0, 200) of a unit of 1 cm with z up, its node moved by
/// 1 m along x.
std::string triangle_dae(const char* up) {
  return std::string(R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="centimeter"/><up_axis>)") +
         up + R"(</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>
<diffuse><color>1 1 1 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 0 200</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="m" count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>100 0 0</translate>
<instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry>
</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

/// A glTF 2.0 of one triangle (0, 0, 0), (1, 0, 0), (0, 2, 0), y up; binary (.glb) or with its
/// numbers in a file of their own.
struct Gltf {
  std::string json, numbers;
  explicit Gltf(const std::string& uri) {
    const float p[9] = {0, 0, 0, 1, 0, 0, 0, 2, 0};
    numbers.assign(reinterpret_cast<const char*>(p), sizeof p);
    json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
           R"("nodes":[{"mesh":0,"translation":[0,0,3]}],)"
           R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],)"
           R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1]}}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",)"
           R"("min":[0,0,0],"max":[1,2,0]}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{)" +
           uri + R"("byteLength":36}]})";
  }
  std::string binary() const {
    std::string text = json;
    while (text.size() % 4 != 0) text += ' ';
    const auto word = [](std::size_t value) {
      const auto w = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&w), 4);
    };
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + numbers.size()) + word(text.size()) +
           "JSON" + text + word(numbers.size()) + std::string("BIN\0", 4) + numbers;
  }
};

TEST(MeshFile, ReadsAnObjWithItsTexture) {
  const test::Folder folder("mesh obj");
  const std::string path = folder.write("room.obj", test::room_obj(4, 3, 2));
  folder.write("room.mtl", test::room_mtl());
  folder.write("stripes.pgm", test::two_greys_pgm());
  const TexturedMesh mesh = read_mesh_file(path);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_LT((bounds(mesh).min() - Eigen::Vector3f(0, 0, 0)).norm(), 1e-5);
  EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(4, 3, 2)).norm(), 1e-5);
  for (const std::uint32_t material : mesh.material) {
    const Image& texture = mesh.textures[material];
    ASSERT_EQ(texture.width, 2);
    EXPECT_EQ(texture.at(0, 0), 40);
    EXPECT_EQ(texture.at(1, 0), 200);
  }
  // The floor's uv: (0, 0) of the file is the lower left of the image, v = 1 here.
  bool found = false;
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    if (mesh.vertices[n].norm() > 1e-5) continue;
    EXPECT_FLOAT_EQ(mesh.uv[n].x(), 0.0f);
    EXPECT_FLOAT_EQ(mesh.uv[n].y(), 1.0f);
    found = true;
  }
  EXPECT_TRUE(found);
  // The floor faces upwards.
  const auto& [a, b, c] = mesh.triangles[0];
  EXPECT_GT((mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).z(),
            0.0f);
  // Gazebo's view of the same numbers.
  EXPECT_LT((bounds(read_mesh_file(path, UpAxis::kZ)).max() - Eigen::Vector3f(4, 2, 0)).norm(),
            1e-5);
}

TEST(MeshFile, AMissingTextureIsPlain) {
  const test::Folder folder("mesh plain");
  const std::string path = folder.write("room.obj", test::room_obj(4, 3, 2));
  folder.write("room.mtl", test::room_mtl());
  for (const std::string content : {"", "P5 9999 9999 255 torn"}) {
    if (!content.empty()) folder.write("stripes.pgm", content);
    const TexturedMesh mesh = read_mesh_file(path);
    const Image& texture = mesh.textures[mesh.material[0]];
    ASSERT_EQ(texture.pixels.size(), 1u);
    EXPECT_NEAR(texture.at(0, 0), 127.5, 0.5);
    EXPECT_EQ(mesh.left_out.text(), content.empty() ? "texture 'stripes.pgm' (absent)"
                                                    : "texture 'stripes.pgm' (cannot be read)");
  }
  std::filesystem::remove(folder.path("room.mtl"));
  const TexturedMesh bare = read_mesh_file(path);
  EXPECT_EQ(bare.triangles.size(), 12u);
  EXPECT_EQ(bare.left_out.text(), "material file 'room.mtl' (absent)");
}

TEST(MeshFile, ReadsStlAndPlyWithZUp) {
  const test::Folder folder("mesh stl");
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2 3\n"
      "endloop\nendfacet\nendsolid a\n";
  std::string binary(80, ' ');
  const std::uint32_t one = 1;
  binary.append(reinterpret_cast<const char*>(&one), 4);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 3};
  binary.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
  binary += std::string(2, '\0');
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 3\n"
      "3 0 1 2\n";
  for (const std::string& path :
       {folder.write("a.stl", stl), folder.write("b.STL", binary), folder.write("c.ply", ply)}) {
    for (const UpAxis unsaid : {UpAxis::kY, UpAxis::kZ}) {
      const TexturedMesh mesh = read_mesh_file(path, unsaid);
      ASSERT_EQ(mesh.triangles.size(), 1u) << path;
      EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(1, 2, 3)).norm(), 1e-5) << path;
    }
  }
  // A cloud of points, and a file that says it is longer than it is.
  EXPECT_NE(problem(folder.write("d.ply",
                                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float "
                                 "x\nproperty float y\nproperty float z\nend_header\n0 0 "
                                 "0\n")),
            "");
  EXPECT_NE(problem(folder.write("e.stl", binary.substr(0, 100))), "");
}

TEST(MeshFile, GltfThatWouldBeReadWrongIsRefusedByName) {
  const test::Folder folder("mesh gltf extensions");
  const std::string plain = Gltf("").json;
  const auto with = [&](const std::string& from, const std::string& to) {
    Gltf gltf("");
    const std::size_t at = plain.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    gltf.json = std::string(plain).replace(at, from.size(), to);
    return folder.write("t.glb", gltf.binary());
  };
  const auto requiring = [&](const std::string& names) {
    return with(R"("scene":0,)", R"("scene":0,"extensionsUsed":[)" + names +
                                     R"(],"extensionsRequired":[)" + names + "],");
  };
  for (const char* name : {"KHR_mesh_quantization", "EXT_meshopt_compression",
                           "KHR_draco_mesh_compression", "EXT_mesh_gpu_instancing", "ACME_shape"}) {
    EXPECT_NE(problem(requiring('"' + std::string(name) + '"')).find(name), std::string::npos);
  }
  const std::string both =
      problem(requiring(R"("KHR_mesh_quantization","EXT_meshopt_compression")"));
  EXPECT_NE(both.find("requires 'KHR_mesh_quantization', 'EXT_meshopt_compression'"),
            std::string::npos)
      << both;
  EXPECT_NE(
      problem(with(R"("scene":0,)", R"("scene":0,"extensionsUsed":["EXT_mesh_gpu_instancing"],)"))
          .find("EXT_mesh_gpu_instancing"),
      std::string::npos);
  EXPECT_NE(problem(with(R"("componentType":5126)", R"("componentType":5122,"normalized":true)"))
                .find("POSITION of component type 5122 (16 bits)"),
            std::string::npos);
  {
    Gltf gltf("");
    gltf.json = plain;
    gltf.json.replace(gltf.json.find(R"({"POSITION":0})"), 14, R"({"POSITION":0,"TEXCOORD_0":1})");
    gltf.json.replace(gltf.json.find(R"("max":[1,2,0]})"), 14,
                      R"("max":[1,2,0]},{"bufferView":0,"componentType":5123,"normalized":true,)"
                      R"("count":3,"type":"VEC2"})");
    EXPECT_NE(
        problem(folder.write("uv.glb", gltf.binary())).find("TEXCOORD_0 of component type 5123"),
        std::string::npos);
  }
  // What only says how a surface looks is no reason to refuse it.
  for (const char* name : {"KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"}) {
    EXPECT_EQ(problem(requiring('"' + std::string(name) + '"')), "") << name;
  }
}

TEST(MeshFile, NamesWithBackslashesAreFolders) {
  const test::Folder folder("mesh backslashes");
  folder.write("looks/room.mtl", "newmtl stripes\nKd 0.5 0.5 0.5\nmap_Kd textures\\stripes.pgm\n");
  folder.write("textures/stripes.pgm", test::two_greys_pgm());
  std::string obj = test::room_obj(4, 3, 2);
  obj.replace(obj.find("room.mtl"), 8, "looks\\room.mtl");
  const TexturedMesh mesh = read_mesh_file(folder.write("room.obj", obj));
  EXPECT_EQ(mesh.left_out.text(), "");
  EXPECT_EQ(mesh.textures[mesh.material[0]].width, 2);
}

TEST(MeshFile, HostileFilesEndWithinTheirLimits) {
  const test::Folder folder("mesh hostile");
  // A letter amid the indices, for which the library makes vertices without end.
  std::string dae = triangle_dae("Z_UP");
  const std::string indices = "<p>0 1 2</p>";
  dae.replace(dae.find("offset=\"0\"/><p>"), 11, "offsEt=\"0\"");
  dae.replace(dae.find(indices), indices.size(), "<p>0 1`2</p>");
  EXPECT_NE(problem(folder.write("endless.dae", dae)), "");
  // A chain of nodes that the library follows by calling itself.
  constexpr int kNodes = 40000;
  std::string nodes;
  for (int n = 0; n + 1 < kNodes; ++n) nodes += "{\"children\":[" + std::to_string(n + 1) + "]},";
  Gltf gltf("");
  const std::string one = R"("nodes":[{"mesh":0,"translation":[0,0,3]}])";
  gltf.json.replace(gltf.json.find(one), one.size(), "\"nodes\":[" + nodes + R"({"mesh":0}])");
  EXPECT_NE(problem(folder.write("chain.glb", gltf.binary())).find("reader crashed"),
            std::string::npos);
  // JSON within JSON, and buffers that are none.
  EXPECT_NE(problem(folder.write("deep.gltf", std::string(1000000, '['))), "");
  // Pipes and devices that they name.
  ASSERT_EQ(::mkfifo(folder.path("pipe").c_str(), 0600), 0);
  for (const std::string name : {"pipe", "/dev/zero"}) {
    EXPECT_NE(problem(folder.write("a.gltf", Gltf("\"uri\":\"" + name + "\",").json)).find(name),
              std::string::npos);
    EXPECT_NE(
        problem(folder.write("a.obj", "mtllib " + name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"))
            .find("not a regular file"),
        std::string::npos);
  }
}

TEST(MeshFile, WhatFuzzingFoundEndsWithinItsLimits) {
  const std::filesystem::path crashes = std::string(PROSPECT_SHARED_DATA) + "/crashes";
  if (!std::filesystem::exists(crashes)) GTEST_SKIP() << crashes << " is absent";
  const test::Folder folder("mesh fuzzed");
  for (const std::string kind : {"dae", "glb"}) {
    for (const auto& entry : std::filesystem::directory_iterator(crashes / kind)) {
      const std::string path = folder.write("crash." + kind, "");
      std::filesystem::copy_file(entry.path(), path,
                                 std::filesystem::copy_options::overwrite_existing);
      try {
        EXPECT_FALSE(read_mesh_file(path).triangles.empty());
      } catch (const InputError& error) {
        EXPECT_EQ(error.lines().size(), 1u);
      }
    }
  }
  for (const char* name : {"dae_12GB.dae", "gltf_20000_nested_nodes.gltf"}) {
    EXPECT_NE(problem((crashes / name).string()), "") << name;
  }
}

TEST(MeshFile, HonoursUnitUpAxisAndNodes) {
  const test::Folder folder("mesh dae");
  const Eigen::AlignedBox3f z_up =
      bounds(read_mesh_file(folder.write("z.dae", triangle_dae("Z_UP"))));
  EXPECT_LT((z_up.min() - Eigen::Vector3f(1, 0, 0)).norm(), 1e-5);
  EXPECT_LT((z_up.max() - Eigen::Vector3f(2, 0, 2)).norm(), 1e-5);
  const Eigen::AlignedBox3f y_up =
      bounds(read_mesh_file(folder.write("y.dae", triangle_dae("Y_UP"))));
  EXPECT_LT((y_up.min() - Eigen::Vector3f(1, -2, 0)).norm(), 1e-5);
  EXPECT_LT((y_up.max() - Eigen::Vector3f(2, 0, 0)).norm(), 1e-5);
}

TEST(MeshFile, WhoeverReadsItSaysWhatIsUp) {
  const test::Folder folder("mesh up");
  const auto high = [&](const std::string& name, const std::string& text, UpAxis up) {
    return bounds(read_mesh_file(folder.write(name, text), UpAxis::kY, {}, {}, up));
  };
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 4\nf 1 2 3\nf 1 2 4\n";
  EXPECT_LT((high("a.obj", obj, UpAxis::kX).max() - Eigen::Vector3f(0, 0, 1)).norm(), 1e-6);
  EXPECT_LT((high("a.obj", obj, UpAxis::kX).min() - Eigen::Vector3f(-2, -4, 0)).norm(), 1e-6);
  EXPECT_LT((high("a.obj", obj, UpAxis::kY).max() - Eigen::Vector3f(1, 0, 2)).norm(), 1e-6);
  EXPECT_LT((high("a.obj", obj, UpAxis::kZ).max() - Eigen::Vector3f(1, 2, 4)).norm(), 1e-6);
  // Whatever the file says: its own numbers count.
  for (const char* says : {"X_UP", "Y_UP", "Z_UP"}) {
    EXPECT_LT(
        (high("a.dae", triangle_dae(says), UpAxis::kZ).max() - Eigen::Vector3f(2, 0, 2)).norm(),
        1e-5);
  }
  const std::string gltf = Gltf("").binary();
  EXPECT_LT((high("a.glb", gltf, UpAxis::kZ).max() - Eigen::Vector3f(1, 2, 3)).norm(), 1e-5);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(MeshFile, ColladaInEverySpellingOfXml) {
  const test::Folder folder("mesh spellings");
  const std::string dae = triangle_dae("Z_UP");
  const std::string camera =
      "<instance_camera url='#c'/><instance_camera url='#d'/>"
      "<instance_light url='#e'/>";
  const std::string cameras =
      "<library_cameras><camera id='c'/><camera id='d'/></library_cameras><library_lights>"
      "<light id='l'/></library_lights><library_geometries>";
  const std::string spellings[] = {
      replaced(dae, "<color>1", "<color> \n1"),
      replaced(dae, "1 1 1 1</color>", "1\n1\t1 1 \n</color>"),
      replaced(dae, ">Z_UP<", ">\n Z_UP \n<"),
      replaced(dae, "meter=\"0.01\"", "meter=' 0.01 '"),
      replaced(dae, "<p>0 1 2", "<p>\n  0 <!-- then --> 1 2\n"),
      replaced(dae, "count=\"9\">0 0 0", "count=\" 9 \"> <!-- --> 0 0\r\n0"),
      replaced(dae, "<translate>", "<translate>\n\t"),
      replaced(dae, "url=\"#g\"", "url=\" #g\""),
      replaced(dae, "<translate>100 0 0", "<translate><![CDATA[100 0 0]]>"),
      replaced(replaced(dae, "<instance_geometry", camera + "<instance_geometry"),
               "<library_geometries>", cameras)};
  for (const std::string& text : spellings) {
    const TexturedMesh mesh = read_mesh_file(folder.write("a.dae", text));
    EXPECT_LT((bounds(mesh).min() - Eigen::Vector3f(1, 0, 0)).norm(), 1e-5) << text;
    EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(2, 0, 2)).norm(), 1e-5) << text;
    EXPECT_EQ(mesh.textures[mesh.material[0]].at(0, 0), 255) << text;
    EXPECT_EQ(mesh.left_out.text(), &text == std::end(spellings) - 1 ? "2 cameras, 1 light" : "");
  }
}

TEST(MeshFile, ColladaPolygonsMayHaveHoles) {
  const test::Folder folder("mesh holes");
  // A wall of 4 x 3 m in the x-z plane with a window of 1 x 1 m, a plain polygon below.
  std::string dae = triangle_dae("Z_UP");
  dae = replaced(dae, "count=\"9\">0 0 0 100 0 0 0 0 200",
                 "count=\"36\">0 0 0 400 0 0 400 0 300 0 0 300 100 0 100 200 0 100 200 0 200 "
                 "100 0 200 0 0 -100 400 0 -100 400 0 -50 0 0 -50");
  dae = replaced(dae, "count=\"3\"", "count=\"12\"");
  const std::size_t begin = dae.find("<triangles"), end = dae.find("</triangles>");
  const auto with = [&](const std::string& plain) {
    return dae.substr(0, begin) +
           "<polygons material='m' count='1'><input semantic='VERTEX' source='#v' offset='0'/>" +
           plain + "<ph><p> 0 1 2 3</p><h>4 5 6 7 </h></ph></polygons>" +
           dae.substr(end + std::string("</triangles>").size());
  };
  const auto area = [&](const std::string& text) {
    const TexturedMesh mesh = read_mesh_file(folder.write("a.dae", text));
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Eigen::Vector3f normal =
          0.5f * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
      EXPECT_LT(normal.y(), 0.0f);  // as the polygon faces
      sum += normal.norm();
    }
    return sum;
  };
  EXPECT_NEAR(area(with("")), 11.0, 1e-4);
  EXPECT_NEAR(area(with("<p>8 9 10 11</p>")), 13.0, 1e-4);
}

TEST(MeshFile, ReadsGltfInBothForms) {
  const test::Folder folder("mesh gltf");
  const Gltf with_file(R"("uri":"numbers.bin",)");
  folder.write("numbers.bin", with_file.numbers);
  for (const std::string& path :
       {folder.write("t.gltf", with_file.json), folder.write("t.glb", Gltf("").binary())}) {
    const TexturedMesh mesh = read_mesh_file(path);
    ASSERT_EQ(mesh.triangles.size(), 1u) << path;
    EXPECT_LT((bounds(mesh).min() - Eigen::Vector3f(0, -3, 0)).norm(), 1e-5);
    EXPECT_LT((bounds(mesh).max() - Eigen::Vector3f(1, -3, 2)).norm(), 1e-5);
    EXPECT_NEAR(mesh.textures[mesh.material[0]].at(0, 0), 127.5, 0.5);
  }
}

TEST(MeshFile, SaysWhatIsWrong) {
  const test::Folder folder("mesh wrong");
  EXPECT_NE(problem(folder.path("none.obj")).find("no such file"), std::string::npos);
  EXPECT_NE(problem(folder.write("a.fbx", "solid")).find("unknown kind"), std::string::npos);
  EXPECT_NE(problem(folder.write("empty.dae", "")).find("is empty"), std::string::npos);
  std::filesystem::create_directories(folder.path("folder.obj"));
  EXPECT_NE(problem(folder.path("folder.obj")).find("is not a file"), std::string::npos);
  EXPECT_NE(problem(folder.write("points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n")), "");
  EXPECT_NE(problem(folder.write("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")), "");
  EXPECT_NE(problem(folder.write("noise.glb", "glTF is not what this is, at all")), "");
  EXPECT_NE(problem(folder.write("text.gltf", "{\"asset\":")), "");
}

// The library takes "0,5" for 0, and a word for 0.
TEST(MeshFile, AVertexOfAnObjIsThreeNumbers) {
  const test::Folder folder("mesh vertices");
  const std::string face = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* bad :
       {"v 0,5 0 0", "v 0 0", "v a b c", "v 0x1p1 0 0", "v 1e 0 0", "v 0 0 0 x"}) {
    const std::string told =
        problem(folder.write("a.obj", "# a\n" + std::string(bad) + '\n' + face));
    EXPECT_NE(told.find("a.obj:2: the line '" + std::string(bad) + "'; expected v and three"),
              std::string::npos)
        << told;
  }
  for (const char* good : {"v  0\t0 0 ", "v +0.5 1e-3 -.5", "v 0 0 0 1.0",
                           "v 0 0 0 0.1 0.2 0.3 # c", "v 0 0 \\\n0", "v 0 0 0\r"}) {
    EXPECT_EQ(problem(folder.write("a.obj", std::string(good) + '\n' + face)), "") << good;
  }
}

// The library reads on behind the numbers, whatever lies there, or makes vertices without end.
TEST(MeshFile, ColladaListsAreAsLongAsTheyAreSaidToBe) {
  const test::Folder folder("mesh lists");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string dae = triangle_dae("Z_UP");
    const std::size_t at = dae.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return problem(folder.write("a.dae", dae.replace(at, from.size(), to)));
  };
  EXPECT_EQ(with("Z_UP", "Z_UP"), "");
  // An accessor may count too much, if no index does.
  EXPECT_EQ(with("count=\"3\" stride", "count=\"9\" stride"), "");
  for (const auto& [from, to] : {std::pair("<accessor ", "<accessor offset=\"1\" "),
                                 {"id=\"a\" count=\"9\"", "id=\"a\" count=\"6\""},
                                 {"stride=\"3\"", "stride=\"4\""}}) {
    EXPECT_NE(with(from, to).find("Invalid data index"), std::string::npos) << to;
  }
  for (const char* bad : {"0 1`2", "0 1.5 2", "0 1 x", "0 1 \u00a02"}) {
    EXPECT_NE(
        with("<p>0 1 2</p>", "<p>" + std::string(bad) + "</p>").find("expected whole numbers"),
        std::string::npos)
        << bad;
  }
  EXPECT_NE(with("Z_UP", "W_UP").find("<up_axis> is 'W_UP'; expected X_UP"), std::string::npos);
}

TEST(MeshFile, SurvivesTornFiles) {
  // Cut anywhere: an error of one line or a mesh that is whole, never anything else.
  const test::Folder folder("mesh torn");
  int refused = 0;
  for (const auto& [name, text] :
       {std::pair<std::string, std::string>{"t.dae", triangle_dae("Z_UP")},
        {"t.glb", Gltf("").binary()},
        {"t.obj", test::room_obj(4, 3, 2)}}) {
    for (std::size_t length = 1; length < text.size(); length += 1 + text.size() / 60) {
      const std::string path = folder.write(name, text.substr(0, length));
      try {
        const TexturedMesh mesh = read_mesh_file(path);
        for (const auto& triangle : mesh.triangles) {
          for (const std::uint32_t v : triangle) ASSERT_LT(v, mesh.vertices.size());
        }
        EXPECT_FALSE(mesh.triangles.empty());
      } catch (const InputError& error) {
        EXPECT_EQ(error.lines().size(), 1u);
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(MeshFile, ATriangleThatIsMirroredKeepsItsOutside) {
  TexturedMesh part;
  part.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  part.uv.assign(3, {0, 0});
  part.triangles = {{0, 1, 2}};
  part.material = {1};
  TexturedMesh whole;
  append_triangles(part, Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)), 0, whole);
  append_triangles(part, Eigen::Affine3d(Eigen::Translation3d(5, 0, 0)), 7, whole);
  ASSERT_EQ(whole.triangles.size(), 2u);
  for (const auto& [a, b, c] : whole.triangles) {
    EXPECT_GT(
        (whole.vertices[b] - whole.vertices[a]).cross(whole.vertices[c] - whole.vertices[a]).z(),
        0.0f);
  }
  EXPECT_EQ(whole.material, (std::vector<std::uint32_t>{1, 8}));
  EXPECT_EQ(whole.triangles[1][0], 3u);
}

}  // namespace
}  // namespace prospect::mesh_file_test
