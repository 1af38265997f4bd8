// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_world_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <opencv2/core.hpp>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include "adapters/formats/images/image_codec.h"
#include "adapters/robots/gazebo/number_stream.h"
#include "adapters/robots/gazebo/texture_atlas.h"

namespace prospect {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("gazebo world: " + what);
}

std::string png(const Image& image) {
  const cv::Mat pixels(image.height, image.width, CV_8UC1,
                       const_cast<std::uint8_t*>(image.pixels.data()));
  const std::vector<std::uint8_t> bytes = encode_pixels(".png", pixels);
  if (bytes.empty()) refuse("a page of textures cannot be written as PNG");
  return {bytes.begin(), bytes.end()};
}

/// The direction from a triangle into free space, one of the axes'.
Eigen::Vector3d free_side(const World& world, const std::array<Eigen::Vector3d, 3>& corner) {
  const Eigen::Vector3d across = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  int axis = 0;
  across.cwiseAbs().maxCoeff(&axis);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal[axis] = 1.0;
  if (!(std::abs(across.normalized()[axis]) > 0.999999)) {
    refuse("a surface that is not parallel to two axes; expected a world of voxels");
  }
  const Eigen::Vector3d middle = (corner[0] + corner[1] + corner[2]) / 3.0;
  const double resolution = world.voxels.resolution(), half = 0.5 * resolution;
  const auto free = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3i v = (p / resolution).array().floor().cast<int>();
    return world.voxels.state(v.x(), v.y(), v.z()) == CellState::kFree;
  };
  if (free(middle + half * normal)) return normal;
  if (free(middle - half * normal)) return -normal;
  refuse("a surface without free space before it; expected the mesh of this world");
}

struct Scene {
  std::string obj, mtl;
  std::vector<Image> pages;
};

Scene scene_of(const World& world, const TexturedMesh& mesh, const GazeboWorldOptions& options,
               const std::string& name) {
  const std::size_t count = mesh.triangles.size();
  const Eigen::Vector3d light = options.light.normalized();
  std::vector<Eigen::Vector3d> normals(count);
  std::vector<Image> textures = mesh.textures;
  std::vector<bool> lit(textures.size(), false);
  for (std::size_t n = 0; n < count; ++n) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.vertices[mesh.triangles[n][k]].cast<double>();
    }
    normals[n] = free_side(world, corner);
    const std::size_t texture = mesh.material[n];
    if (lit[texture]) continue;
    lit[texture] = true;
    const double shade =
        options.ambient + (1.0 - options.ambient) * 0.5 * (1.0 + normals[n].dot(light));
    for (std::uint8_t& grey : textures[texture].pixels) {
      grey = static_cast<std::uint8_t>(std::lround(std::min(255.0, shade * grey)));
    }
  }
  TextureAtlas atlas = pack_textures(textures);

  std::ostringstream obj = number_stream(), mtl = number_stream();
  obj << "mtllib " << name << ".mtl\n";
  for (const Eigen::Vector3f& v : mesh.vertices) {
    obj << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  // A vertex belongs to one rectangle, so to one texture.
  std::vector<std::size_t> texture_of(mesh.vertices.size(), 0);
  for (std::size_t n = 0; n < count; ++n) {
    for (const std::uint32_t v : mesh.triangles[n]) texture_of[v] = mesh.material[n];
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const std::size_t n = texture_of[v];
    const Eigen::Vector2d uv = atlas.on_page(n, textures[n], mesh.uv[v].cast<double>());
    obj << "vt " << uv.x() << ' ' << 1.0 - uv.y() << '\n';
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {1, -1}) {
      obj << "vn " << (axis == 0 ? sign : 0) << ' ' << (axis == 1 ? sign : 0) << ' '
          << (axis == 2 ? sign : 0) << '\n';
    }
  }
  for (std::size_t page = 0; page < atlas.pages.size(); ++page) {
    mtl << "newmtl page_" << page << "\nKa 1 1 1\nKd 0 0 0\nKs 0 0 0\nillum 1\nmap_Kd " << name
        << '_' << page << ".png\n";
    obj << "o page_" << page << "\nusemtl page_" << page << '\n';
    for (std::size_t n = 0; n < count; ++n) {
      if (atlas.places[mesh.material[n]].page != page) continue;
      const auto& t = mesh.triangles[n];
      const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
      const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
      const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
      const bool turned = (b - a).cross(c - a).dot(normals[n]) < 0.0;
      int axis = 0;
      normals[n].cwiseAbs().maxCoeff(&axis);
      const int normal = 2 * axis + (normals[n][axis] > 0.0 ? 1 : 2);
      obj << 'f';
      for (const std::uint32_t v : {t[0], turned ? t[2] : t[1], turned ? t[1] : t[2]}) {
        obj << ' ' << v + 1 << '/' << v + 1 << '/' << normal;
      }
      obj << '\n';
    }
  }
  return {obj.str(), mtl.str(), std::move(atlas.pages)};
}

/// Columns [i, i + width) x [j, j + height) of the grid.
struct Block {
  int i, j, width, height;
};

/// All columns that are not free up to a height, as rectangles, row by row as wide and then as high
/// as they go.
std::vector<Block> blocks_of(const World& world, double top) {
  const GridFrame& f = world.voxels.frame();
  const int high = std::min(static_cast<int>(std::ceil(top / world.voxels.resolution())),
                            world.voxels.k0() + world.voxels.depth());
  std::vector<std::uint8_t> solid(static_cast<std::size_t>(f.width) *
                                  static_cast<std::size_t>(f.height));
  const auto at = [&](int i, int j) -> std::uint8_t& {
    return solid[static_cast<std::size_t>(j) * static_cast<std::size_t>(f.width) +
                 static_cast<std::size_t>(i)];
  };
  for (int j = 0; j < f.height; ++j) {
    for (int i = 0; i < f.width; ++i) {
      for (int k = 0; k < high && at(i, j) == 0; ++k) {
        at(i, j) = world.solid(f.i0 + i, f.j0 + j, k) ? 1 : 0;
      }
    }
  }
  std::vector<Block> blocks;
  for (int j = 0; j < f.height; ++j) {
    for (int i = 0; i < f.width; ++i) {
      if (at(i, j) == 0) continue;
      Block b{i, j, 0, 1};
      while (i + b.width < f.width && at(i + b.width, j) != 0) ++b.width;
      const auto whole = [&](int row) {
        for (int n = 0; n < b.width; ++n) {
          if (at(i + n, row) == 0) return false;
        }
        return true;
      };
      while (j + b.height < f.height && whole(j + b.height)) ++b.height;
      for (int row = 0; row < b.height; ++row) {
        for (int n = 0; n < b.width; ++n) at(i + n, j + row) = 0;
      }
      blocks.push_back({f.i0 + b.i, f.j0 + b.j, b.width, b.height});
    }
  }
  return blocks;
}

std::string sdf(const World& world, const std::string& robot, double top, const std::string& name) {
  std::ostringstream out = number_stream();
  out << "<?xml version=\"1.0\"?>\n<sdf version=\"1.6\">\n<world name=\"" << name
      << "\">\n<physics type=\"ode\"><max_step_size>0.002</max_step_size>"
         "<real_time_update_rate>500</real_time_update_rate></physics>\n"
         "<scene><ambient>1 1 1 1</ambient><background>0.7 0.7 0.7 1</background>"
         "<shadows>0</shadows></scene>\n<model name=\"scene\"><static>1</static>"
         "<link name=\"surfaces\">\n<visual name=\"surfaces\"><geometry><mesh><uri>"
      << name
      << ".obj</uri></mesh></geometry></visual>\n<collision name=\"floor\"><geometry><plane>"
         "<normal>0 0 1</normal><size>200 200</size></plane></geometry></collision>\n";
  const double resolution = world.voxels.resolution();
  int number = 0;
  for (const Block& b : blocks_of(world, top)) {
    out << "<collision name=\"wall_" << number++ << "\"><pose>"
        << resolution * (b.i + 0.5 * b.width) << ' ' << resolution * (b.j + 0.5 * b.height) << ' '
        << 0.5 * top << " 0 0 0</pose><geometry><box><size>" << resolution * b.width << ' '
        << resolution * b.height << ' ' << top << "</size></box></geometry></collision>\n";
  }
  out << "</link></model>\n" << robot << "</world>\n</sdf>\n";
  return out.str();
}

}  // namespace

std::vector<std::pair<std::string, std::string>> gazebo_world_files(
    const World& world, const TexturedMesh& mesh, const RobotDescription& robot,
    const GazeboWorldOptions& options, const std::string& name) {
  const std::string model = gazebo_robot_model(
      robot, options.robot,
      {{world.start.position.x(), world.start.position.y(), 0.0}, world.start.yaw});
  const auto positive = [](const char* what, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      refuse(std::string(what) + " is " + std::to_string(value) + "; expected a number > 0");
    }
  };
  positive("wall_height", options.wall_height);
  positive("light", options.light.norm());
  if (!(options.ambient >= 0.0 && options.ambient <= 1.0)) refuse("ambient; expected 0..1");
  if (mesh.textures.size() * 2 != mesh.triangles.size()) {
    refuse("a mesh that is not one of rectangles; expected that of a world of voxels");
  }
  const Scene scene = scene_of(world, mesh, options, name);
  std::vector<std::pair<std::string, std::string>> files = {{name + ".obj", scene.obj},
                                                            {name + ".mtl", scene.mtl}};
  for (std::size_t n = 0; n < scene.pages.size(); ++n) {
    files.emplace_back(name + "_" + std::to_string(n) + ".png", png(scene.pages[n]));
  }
  files.emplace_back(name + ".sdf",
                     sdf(world, model, std::max(options.wall_height, robot.slice().z_max), name));
  return files;
}

}  // namespace prospect
