// SPDX-License-Identifier: Apache-2.0
// Writes the inputs that the fuzzing targets begin with: FOLDER/NAME/... for each fuzz_NAME.
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <zlib.h>

#ifdef PROSPECT_WITH_SQLITE
#include <sqlite3.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/mission_topics.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/problem_file/problem_file.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/map_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/octomap_msgs.h"
#include "adapters/formats/ros/rcl_interfaces.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/log/mission_log.h"
#include "adapters/missions/log/planner_calls.h"
#include "tests/adapters/filled_message.h"
#include "tests/adapters/mesh_files.h"
#include "tests/adapters/point_clouds.h"
#include "tests/adapters/ros_bag_writer.h"
#include "tests/adapters/synthetic_run.h"
#include "tests/engine/problem_specifications.h"

using namespace prospect;

namespace {

namespace fs = std::filesystem;

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string image(const char* extension, int type) {
  cv::Mat pixels(12, 16, type, cv::Scalar::all(205));
  pixels(cv::Rect(2, 2, 10, 8)).setTo(cv::Scalar::all(254));
  std::vector<unsigned char> bytes;
  cv::imencode(extension, pixels, bytes);
  return {bytes.begin(), bytes.end()};
}

/// A small room as an octree of the given kind.
template <typename Tree>
Tree room_tree() {
  Tree tree(0.1);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      for (int z = -1; z < 8; ++z) {
        const bool solid = z < 0 || x % 19 == 0 || y % 19 == 0;
        tree.updateNode(octomap::point3d(0.1f * static_cast<float>(x) + 0.05f,
                                         0.1f * static_cast<float>(y) + 0.05f,
                                         0.1f * static_cast<float>(z) + 0.05f),
                        solid);
      }
    }
  }
  return tree;
}

const char* const kSdf =
    "<?xml version='1.0'?>\n<sdf version='1.9'><world name='w'><include><uri>model://sun</uri>"
    "</include><include><uri>model://ground_plane</uri><pose degrees='true'>0 0 0 0 0 90</pose>"
    "</include><frame name='f'><pose>1 0 0 0 0 0</pose></frame><model name='m' placement_frame='l'>"
    "<pose relative_to='f'>1 2 0 0 0 1</pose><link name='l'><visual name='v'><geometry><box><size>"
    "1 2 3</size></box></geometry><material><diffuse>0.1 0.2 0.3 1</diffuse></material></visual>"
    "<visual name='s'><geometry><polyline><point>0 0</point><point>1 0</point><point>0 1</point>"
    "<height>1</height></polyline></geometry></visual><collision name='c'><geometry><sphere>"
    "<radius>1</radius></sphere></geometry></collision></link><model name='n'><link name='k'>"
    "<visual name='v'><geometry><capsule><radius>0.2</radius><length>1</length></capsule>"
    "</geometry></visual></link></model></model><state world_name='w'><model name='m'><pose>0 0 1 0"
    " 0 0</pose><link name='l'><pose>0 0 1 0 0 0</pose></link></model></state></world></sdf>\n";

const char* const kStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 0 4 0\nendloop\n"
    "endfacet\nendsolid a\n";
const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n4 0 0\n0 4 0\n"
    "3 0 1 2\n";
const char* const kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
    R"("translation":[0,0,3]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],)"
    R"("max":[1,2,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)"
    R"("uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA"}]})";
const char* const kDae =
    "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
    "version=\"1.4.1\"><asset><unit meter=\"0.01\" name=\"cm\"/><up_axis>Z_UP</up_axis></asset>"
    "<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
    "count=\"9\">0 0 0 100 0 0 0 100 0</float_array><technique_common><accessor source=\"#pa\" "
    "count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
    "type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
    "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles "
    "count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></triangles>"
    "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node "
    "id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>"
    "<instance_visual_scene url=\"#s\"/></scene></COLLADA>";

const char* const kInfo =
    "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [400, 0, 320, 0, 400, 240, 0, 0, 1]\ndistortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0, 0, 0, 0]\n"
    "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [400, 0, 320, -40, 0, 400, 240, 0, 0, 0, 1, "
    "0]\n";
const char* const kCamchain =
    "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.0, 0.0, 0.0]\n  "
    "distortion_model: "
    "radtan\n  intrinsics: [400.0, 400.0, 320.0, 240.0]\n  resolution: [640, 480]\n  rostopic: /a\n"
    "cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.1]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, "
    "0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.0, 0.0, "
    "0.0]\n  distortion_model: equidistant\n  intrinsics: [400.0, 400.0, 320.0, 240.0]\n  "
    "resolution: [640, 480]\n";
const char* const kOpenCv =
    "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 400., 0., "
    "320., 0., 400., 240., 0., 0., 1. ]\nD1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   "
    "data: [ 0.1, 0., 0., 0., 0. ]\nM2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   "
    "data: "
    "[ 400., 0., 320., 0., 400., 240., 0., 0., 1. ]\nD2: !!opencv-matrix\n   rows: 1\n   cols: 5\n "
    " "
    " dt: d\n   data: [ 0.1, 0., 0., 0., 0. ]\nR: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: "
    "d\n"
    "   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT: !!opencv-matrix\n   rows: 3\n   cols: 1\n "
    "  "
    "dt: d\n   data: [ -0.1, 0., 0. ]\n";

std::string camera_info() {
  test::CdrWriter info;
  info.header(1'000'000'000, "camera").number(std::uint32_t{480}).number(std::uint32_t{640});
  info.text("plumb_bob").number(std::uint32_t{5}).doubles({0.1, 0, 0, 0, 0});
  info.doubles({400, 0, 320, 0, 400, 240, 0, 0, 1}).doubles({1, 0, 0, 0, 1, 0, 0, 0, 1});
  info.doubles({400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0});
  for (int k = 0; k < 6; ++k) info.number(std::uint32_t{0});  // binning, region of interest
  return info.number(std::uint8_t{0}).str();
}

std::string ros_image(std::int64_t time) {
  test::CdrWriter message;
  message.header(time, "camera").number(std::uint32_t{4}).number(std::uint32_t{6});
  message.text("mono8").number(std::uint8_t{0}).number(std::uint32_t{6});
  return message.bytes(std::string(24, '\x40')).str();
}

std::string odometry_message() {
  test::CdrWriter message;
  message.header(1'000'000'000, "odom").text("base").pose(Eigen::Isometry3d::Identity());
  return message.doubles(std::vector<double>(36 + 6 + 36, 0.0)).str();
}

std::string transforms() {
  test::CdrWriter message;
  message.number(std::uint32_t{1}).header(1'000'000'000, "odom").text("base");
  return message.doubles({0, 0, 0, 0, 0, 0, 1}).str();
}

std::vector<test::BagMessage> bag_messages() {
  return {{"/image", "sensor_msgs/msg/Image", 1, ros_image(1)},
          {"/info", "sensor_msgs/msg/CameraInfo", 1, camera_info()},
          {"/image", "sensor_msgs/msg/Image", 2, ros_image(2)}};
}

std::string mcap(int per_chunk) {
  return test::mcap_of(
      bag_messages(), per_chunk, "", [](const std::string& records) { return records; },
      [](const std::string& records) {
        return static_cast<std::uint32_t>(
            ::crc32(0, reinterpret_cast<const unsigned char*>(records.data()),
                    static_cast<unsigned>(records.size())));
      });
}

#ifdef PROSPECT_WITH_SQLITE
std::string database(const std::string& path) {
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  for (const char* sql :
       {"PRAGMA page_size=512",
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
        "TEXT, offered_qos_profiles TEXT)",
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
        "BLOB)",
        "INSERT INTO topics VALUES(1,'/image','sensor_msgs/msg/Image','cdr','')"}) {
    sqlite3_exec(database, sql, nullptr, nullptr, nullptr);
  }
  const std::string bytes = ros_image(1);
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(1,1,?)", -1,
                     &insert, nullptr);
  sqlite3_bind_blob(insert, 1, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
  sqlite3_step(insert);
  sqlite3_finalize(insert);
  sqlite3_close(database);
  return content(path);
}
#endif

std::string problem_file(const std::string& path) {
  PlannerParameters p;
  p.N = 6;
  p.M = 3;
  p.committed = 0.5;
  p.visibility.r_max = 1.5;
  p.max_targets = 20;
  const test::NamedSpecification named = test::specification_of("corpus", "unicycle", p, 60);
  SavedProblem saved;
  saved.specification = *named.specification;
  saved.seeds = named.seeds;
  write_problem(path, saved);
  return content(path);
}

ros::LaserScan laser_scan() {
  ros::LaserScan scan;
  scan.angle_min = -1.0F;
  scan.angle_max = 1.0F;
  scan.angle_increment = 0.5F;
  scan.range_min = 0.1F;
  scan.range_max = 8.0F;
  scan.ranges = {1.0F, 2.0F, HUGE_VALF, 8.0F, 0.0F};
  return scan;
}

std::string point_cloud() {
  const float points[] = {1.0F, 2.0F, 0.5F, 3.0F, 4.0F, 0.5F};
  ros::PointCloud2 cloud;
  cloud.height = 1;
  cloud.width = 2;
  for (const char* axis : {"x", "y", "z"}) {
    const auto offset = static_cast<std::uint32_t>(4 * cloud.point_fields.size());
    cloud.point_fields.push_back({axis, offset, ros::PointField::kFloat32, 1});
  }
  cloud.point_step = 12;
  cloud.row_step = 24;
  cloud.data = {reinterpret_cast<const std::uint8_t*>(points), sizeof points};
  return ros::to_cdr(cloud);
}

/// One message of each type, in the order of cdr_fuzz.cc.
template <ros::Message... T>
std::vector<std::string> filled_messages() {
  return {ros::to_cdr(test::filled<T>())...};
}

/// A short run with little in each step, as a log.
std::string mission_log(const std::string& path) {
  RunRecord run = synthetic_run(11);
  {
    const Configuration defaults = configuration_from_text("", "defaults");
    RunStart start;
    start.world = "rooms";
    start.configuration = effective_yaml(defaults.entries);
    MissionLogOptions options;
    options.messages.robot = defaults.robot;
    options.images = true;
    options.file.wait = true;
    MissionLog log(path, start, options);
    for (StepRecord& step : run.steps) {
      step.stamp = step.time;
      step.map_changes.resize(std::min<std::size_t>(step.map_changes.size(), 20));
      step.frontier_cells.resize(std::min<std::size_t>(step.frontier_cells.size(), 5));
      step.landmarks.resize(std::min<std::size_t>(step.landmarks.size(), 5));
      if (step.step % 10 == 0) log.on_record(step, {});
    }
    log.finish(run);
  }
  return content(path);
}

/// Its messages, as logged_run_fuzz.cc takes them.
std::string messages_of_log(const std::string& path) {
  const BagFile bag = BagFile::open(path);
  const char* const topics[] = {
      topic::kStep, topic::kPlan,       topic::kMarkers,  topic::kCostToGo,
      topic::kMap,  topic::kMapUpdates, topic::kPictures, topic::kPictureFeatures};
  std::map<std::int64_t, std::string> by_time;
  for (std::size_t i = 0; i < std::size(topics); ++i) {
    const BagTopic* topic = bag.find(topics[i]);
    if (!topic) continue;
    for (const BagTopic::Message& message : topic->messages) {
      const std::string bytes = bag.read(message);
      std::string& at = by_time[message.time];
      at += static_cast<char>(i);
      at += at.size() == 1 ? '\1' : '\0';
      at += test::le(bytes.size(), 2) + bytes;
    }
  }
  std::string all;
  for (const auto& [time, bytes] : by_time) all += bytes;
  return all;
}

/// A planner's step as planner_step_fuzz.cc takes it, in which `odd` of 256 bytes are any, and the
/// others keep what they stand for: most settings as they are.
std::string planner_step(unsigned odd) {
  constexpr std::size_t kLength = 600;
  std::string bytes(kLength, '\0');
  std::uint32_t random = odd;
  for (char& c : bytes) {
    random = random * 1664525U + 1013904223U;
    if (random >> 24U < odd) c = static_cast<char>(random >> 16U);
  }
  return bytes;
}

/// Beliefs whose maps and landmarks change, a plan and a task, as planner_calls_fuzz.cc takes them.
std::string planner_calls() {
  PlannerCallWriter writer;
  std::string all;
  const auto add = [&](const PlannerCall& call) {
    const std::string bytes = ros::to_cdr(call);
    all += test::le(bytes.size(), 2) + bytes;
  };
  const GridFrame frame{0.1, -2, -1, 5, 4};
  VoxelGrid voxels(frame, 0.0, 0.3);
  GroundMap ground(frame);
  LandmarkMap landmarks;
  Belief belief;
  for (int n = 0; n < 4; ++n) {
    belief.stamp = 0.5 * n;
    voxels.set(n, 1, n % 2, CellState::kOccupied);
    ground.set({n, 1}, n % 2 == 0 ? CellState::kFree : CellState::kOccupied, n > 1);
    Landmark landmark;
    landmark.id = static_cast<std::uint64_t>(n);
    landmarks.landmarks.push_back(landmark);
    if (n == 3) landmarks.landmarks.erase(landmarks.landmarks.begin());
    belief.voxels = std::make_shared<const VoxelGrid>(voxels);
    belief.ground = std::make_shared<const GroundMap>(ground);
    belief.landmarks = std::make_shared<const LandmarkMap>(landmarks);
    add(n % 2 == 0 ? writer.prepare(belief) : writer.plan(belief));
  }
  add(writer.planned(Plan()));
  add(writer.task(Task::go_to({1.0, 2.0}, 0.5)));
  add(writer.task(Task::explore(Polygon{{0, 0}, {4, 0}, {4, 3}})));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_fuzz_corpus FOLDER\n");
    return 2;
  }
  const fs::path root = argv[1];
  const auto write = [&](const std::string& target, const std::string& name,
                         const std::string& bytes) {
    fs::create_directories(root / target);
    std::ofstream(root / target / name, std::ios::binary) << bytes;
  };
  const auto kind = [](int n) { return std::string(1, static_cast<char>(n)); };
  const std::string scratch = (root / "scratch").string();
  fs::create_directories(root);

  const std::string pgm = image(".pgm", CV_8UC1);
  write("map_yaml", "plain",
        "image: map.pgm\nresolution: 0.05\norigin: [-1.5, -2, 0.3]\nnegate: 0\noccupied_thresh: "
        "0.65\nfree_thresh: 0.196\nmode: trinary\n\x1d" +
            pgm);
  write("map_yaml", "flow",
        "{\"image\": \"map.pgm\", 'resolution': 0.1, origin: [0, 0, 0], negate: true}\x1d" +
            image(".png", CV_8UC4));
  write("map_image", "pgm", kind(0) + pgm);
  write("map_image", "ascii", kind(0) + "P2\n# by hand\n3 2\n15\n15 15 0\n0 15 15\n");
  write("map_image", "bits", kind(0) + "P4\n9 2\n\x12\x34\x56\x78");
  write("map_image", "png", kind(1) + image(".png", CV_8UC1));
  write("map_image", "png16", kind(1) + image(".png", CV_16UC4));
  write("map_image", "bmp", kind(2) + image(".bmp", CV_8UC3));
  write("movingai", "plain", "type octile\nheight 3\nwidth 4\nmap\n@@@@\n@..@\nGSTW\n");
  for (const std::string& name : builtin_world_names()) {
    write("world_yaml", name, builtin_world_text(name));
  }
  write("configuration", "defaults", effective_yaml(read_configuration("").entries));
  write("configuration", "short", "robot: {max_speed: 0.5}\nplanner:\n  solver: hybrid\n");
  write("gazebo_world", "plain", kSdf);

  const std::string obj = test::room_obj(4, 3, 2);
  const std::string meshes[] = {obj, kStl, kPly, kGltf, "", kDae};
  const char* const names[] = {"obj", "stl", "ply", "gltf", "glb", "dae"};
  for (int n = 0; n < 6; ++n) {
    if (!meshes[n].empty()) write("mesh_file", names[n], kind(n) + meshes[n]);
  }
  const auto word = [](std::size_t size) { return test::le(size, 4); };
  std::string json = kGltf;
  json += std::string((4 - json.size() % 4) % 4, ' ');
  const std::string glb =
      "glTF" + word(2) + word(20 + json.size()) + word(json.size()) + "JSON" + json;
  write("mesh_file", "glb", kind(4) + glb);
  const std::string checked[] = {kStl, kPly, kDae, kGltf};
  for (int n = 0; n < 4; ++n) write("mesh_check", std::to_string(n), kind(n) + checked[n]);
  write("mesh_check", "glb", kind(3) + glb);
  write("mesh_check", "binary_stl",
        kind(0) + std::string(80, ' ') + word(1) + std::string(50, '\0'));
  write(
      "mesh_check", "binary_ply",
      kind(1) +
          "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nelement face "
          "1\nproperty list uchar int vertex_indices\nend_header\n" +
          std::string(8, '\0') + "\x01" + word(0));

  const std::vector<Eigen::Vector3d> cloud =
      prospect::test::RoomPoints{.spacing = 0.25, .with_ceiling = false}.points();
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    write("point_cloud", data, kind(0) + prospect::test::pcd(cloud, data));
  }
  std::string ply_cloud = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(cloud.size()) +
                          "\nproperty float x\nproperty double y\nproperty short z\nend_header\n";
  for (const auto& p : cloud) {
    ply_cloud +=
        std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z()) + '\n';
  }
  write("point_cloud", "ply", kind(1) + ply_cloud);

  auto tree = room_tree<octomap::OcTree>();
  for (const bool binary : {true, false}) {
    std::ostringstream out;
    if (binary) {
      tree.writeBinaryConst(out);
    } else {
      tree.write(out);
    }
    write("octree", binary ? "bt" : "ot", out.str());
  }
  std::ostringstream coloured;
  room_tree<octomap::ColorOcTree>().write(coloured);
  write("octree", "colour", coloured.str());

  write("problem_file", "plain", problem_file(scratch));
  write("expression_file", "plain",
        R"json({"problems": [{"name": "HS15", "n": 2, "x0": [-2, 1], "objective": )json"
        R"json("100*(x2-x1^2)^2+(1-x1)^2", "inequalities_nonneg": ["x1*x2-1", "x1+exp(x2)"], )json"
        R"json("equalities_zero": ["x1"], "lower": [null, null], "upper": [0.5, null], )json"
        R"json("f_opt": 306.5}]})json");
  write("calibration", "kitti",
        kind(0) +
            "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nP1: 700 0 600 -380 0 700 180 0 0 0 1 0\n"
            "P2: 700 0 600 40 0 700 180 0 0 0 1 0\nP3: 700 0 600 -340 0 700 180 0 0 0 1 0\n");
  write("calibration", "kalibr", kind(1) + kCamchain);
  write("calibration", "opencv", kind(2) + kOpenCv);
  write("calibration", "ros", kind(3) + kInfo);
  write("trajectory", "tum", "# stamp\n0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n");
  write("pose_graph", "planar",
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0.1 9 0 0 9 0 9\n");
  write("pose_graph", "spatial",
        "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 9 0 0 0 0 0 9 0 0 0 0 9 0 0 0 9 0 0 9 0 9\n");
  write("trajectory", "kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  write("bag", "mcap", kind(0) + mcap(0));
  write("bag", "chunks", kind(0) + mcap(2));
#ifdef PROSPECT_WITH_SQLITE
  fs::remove(scratch);
  write("bag", "sqlite", kind(1) + database(scratch));
#endif
  test::CdrWriter compressed;
  compressed.header(1, "camera").text("png").bytes(image(".png", CV_8UC1));
  write("ros_message", "image", kind(0) + ros_image(1));
  write("ros_message", "compressed", kind(1) + compressed.str());
  write("ros_message", "info", kind(2) + camera_info());
  write("ros_message", "transforms", kind(3) + transforms());
  write("ros_message", "odometry", kind(4) + odometry_message());
  write("ros_message", "header", kind(5) + camera_info());
  int type = 0;
  for (const std::string& message :
       filled_messages<ros::Bool, ros::String, ros::Twist, ros::TwistStamped, ros::TransformStamped,
                       ros::PoseStamped, ros::Image, ros::CompressedImage, ros::CameraInfo,
                       ros::LaserScan, ros::PointCloud2, ros::Odometry, ros::Path,
                       ros::OccupancyGrid, ros::OccupancyGridUpdate, ros::TFMessage,
                       ros::DiagnosticArray, ros::Octomap, ros::Log, ros::MarkerArray>()) {
    write("cdr", std::to_string(type), kind(type) + message);
    ++type;
  }
  write("cdr", "scan", kind(type) + ros::to_cdr(laser_scan()));
  write("cdr", "cloud", kind(type + 1) + point_cloud());
  write("dds_options", "short",
        "scan: /scan\ndepth: {image: none}\ncommand: {dead_man: 0.5, speed: 0.6}\n");
  write("dds_options", "long",
        content((fs::path(PROSPECT_SOURCE_DIR) / "share/ros2/prospect_robot/config/robot.yaml")
                    .string()));
  write("logged_run", "file", kind(0) + mission_log(scratch + ".mcap"));
  write("logged_run", "messages", kind(1) + messages_of_log(scratch + ".mcap"));
  fs::remove(scratch + ".mcap");
  write("planner_calls", "plain", planner_calls());
  for (const unsigned odd : {0U, 8U, 32U, 128U, 255U}) {
    write("planner_step", std::to_string(odd) + " odd", planner_step(odd));
  }
  write("image", "pgm", pgm);
  write("image", "png", image(".png", CV_16UC1));
  write("image", "colour", image(".png", CV_8UC3));
  write("image", "tiff", image(".tiff", CV_8UC1));
  write("step_table", "plain", "t,x,mode\n0,1,explore\n0.5,nan,\"a, b\"\n1,,hold\n");
  fs::remove(scratch);
  return 0;
}
