// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/std_msgs.h"

namespace prospect::ros {

struct UVCoordinate {
  static constexpr const char* kType = "visualization_msgs/msg/UVCoordinate";
  float u = 0.0F;
  float v = 0.0F;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("u", m.u);
    visit("v", m.v);
  }
};

struct MeshFile {
  static constexpr const char* kType = "visualization_msgs/msg/MeshFile";
  std::string filename;
  std::span<const std::uint8_t> data;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("filename", m.filename);
    visit("data", m.data);
  }
};

/// As since Humble.
struct Marker {
  static constexpr const char* kType = "visualization_msgs/msg/Marker";
  static constexpr std::int32_t kArrow = 0, kCube = 1, kSphere = 2, kCylinder = 3, kLineStrip = 4,
                                kLineList = 5, kCubeList = 6, kSphereList = 7, kPoints = 8,
                                kText = 9;
  static constexpr std::int32_t kAdd = 0, kDelete = 2, kDeleteAll = 3;  // actions
  Header header;
  std::string ns;
  std::int32_t id = 0;
  std::int32_t type = 0;
  std::int32_t action = 0;
  Pose pose;
  Vector3 scale;
  ColorRGBA color;
  Duration lifetime;
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text;
  std::string mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("header", m.header);
    visit("ns", m.ns);
    visit("id", m.id);
    visit("type", m.type);
    visit("action", m.action);
    visit("pose", m.pose);
    visit("scale", m.scale);
    visit("color", m.color);
    visit("lifetime", m.lifetime);
    visit("frame_locked", m.frame_locked);
    visit("points", m.points);
    visit("colors", m.colors);
    visit("texture_resource", m.texture_resource);
    visit("texture", m.texture);
    visit("uv_coordinates", m.uv_coordinates);
    visit("text", m.text);
    visit("mesh_resource", m.mesh_resource);
    visit("mesh_file", m.mesh_file);
    visit("mesh_use_embedded_materials", m.mesh_use_embedded_materials);
  }
};

struct MarkerArray {
  static constexpr const char* kType = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("markers", m.markers);
  }
};

}  // namespace prospect::ros
