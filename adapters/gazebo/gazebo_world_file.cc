#include "adapters/gazebo/gazebo_world_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <locale>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <variant>

#include "adapters/gazebo/texture_atlas.h"

namespace prospect {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("gazebo world: " + what);
}

/// A stream that writes numbers as files hold them, whatever the locale.
std::ostringstream numbers() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  return out;
}

std::string png(const Image& image) {
  const cv::Mat pixels(image.height, image.width, CV_8UC1,
                       const_cast<std::uint8_t*>(image.pixels.data()));
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", pixels, bytes)) refuse("a page of textures cannot be written as PNG");
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

  std::ostringstream obj = numbers(), mtl = numbers();
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

/// x y z roll pitch yaw of a camera, whose frame in SDF is x ahead, y left, z up.
std::string sensor_pose(const Eigen::Isometry3d& T_BC) {
  Eigen::Matrix3d R_CS;
  R_CS << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Matrix3d R = T_BC.linear() * R_CS;
  const Eigen::Vector3d p = T_BC.translation();
  std::ostringstream out = numbers();
  const std::array<double, 6> numbers_of_pose = {p.x(),
                                                 p.y(),
                                                 p.z(),
                                                 std::atan2(R(2, 1), R(2, 2)),
                                                 -std::asin(std::clamp(R(2, 0), -1.0, 1.0)),
                                                 std::atan2(R(1, 0), R(0, 0))};
  // Without the sign of a zero.
  for (std::size_t n = 0; n < 6; ++n) out << (n == 0 ? "" : " ") << numbers_of_pose[n] + 0.0;
  return out.str();
}

std::string body_geometry(const RobotShape& shape) {
  std::ostringstream out = numbers();
  const auto cylinder = [&](const Eigen::Vector3d& center, double radius, double height) {
    out << "<pose>" << center.x() << ' ' << center.y() << ' ' << center.z()
        << " 0 0 0</pose><geometry><cylinder><radius>" << radius << "</radius><length>" << height
        << "</length></cylinder></geometry>";
  };
  if (const auto* const c = std::get_if<CylinderShape>(&shape)) {
    cylinder(c->center, c->radius, c->height);
  } else if (const auto* const b = std::get_if<BoxShape>(&shape)) {
    out << "<pose>" << b->center.x() << ' ' << b->center.y() << ' ' << b->center.z()
        << " 0 0 0</pose><geometry><box><size>" << b->size.x() << ' ' << b->size.y() << ' '
        << b->size.z() << "</size></box></geometry>";
  } else {
    refuse("a body that is neither a cylinder nor a box; expected one of them");
  }
  return out.str();
}

std::string inertial(double height, double mass, double x, double y, double z) {
  std::ostringstream out = numbers();
  out << "<inertial><pose>0 0 " << height << " 0 0 0</pose><mass>" << mass
      << "</mass><inertia><ixx>" << x << "</ixx><iyy>" << y << "</iyy><izz>" << z
      << "</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>";
  return out.str();
}

std::string robot_model(const World& world, const RobotDescription& robot,
                        const GazeboWorldOptions& options) {
  const GazeboOptions& names = options.robot;
  const double r = names.wheel_radius, half = 0.5 * names.wheel_separation;
  const PinholeCamera& left = robot.stereo.left;
  std::ostringstream out = numbers();
  out << "<model name=\"" << names.model << "\">\n<pose>" << world.start.position.x() << ' '
      << world.start.position.y() << " 0 0 0 " << world.start.yaw
      << "</pose>\n"
         // Of bodies that it puts to sleep Gazebo tells nothing, wheels at rest among them.
         "<allow_auto_disable>0</allow_auto_disable>\n<link name=\""
      << names.link << "\">\n"
      << inertial(1.25 * r, 8.0, 0.08, 0.08, 0.12) << "\n<collision name=\"body\">"
      << body_geometry(robot.shape) << "</collision>\n";
  const double caster = 0.5 * r;
  for (const int sign : {1, -1}) {
    out << "<collision name=\"caster_" << (sign > 0 ? "front" : "back") << "\"><pose>"
        << sign * 0.8 * half << " 0 " << caster << " 0 0 0</pose><geometry><sphere><radius>"
        << caster
        << "</radius></sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2></ode>"
           "</friction></surface></collision>\n";
  }
  const auto camera = [&](double fov, double width, double height, double near, double far) {
    std::ostringstream text = numbers();
    text << "<horizontal_fov>" << fov << "</horizontal_fov><image><width>" << width
         << "</width><height>" << height << "</height><format>R8G8B8</format></image><clip><near>"
         << near << "</near><far>" << far << "</far></clip>";
    return text.str();
  };
  const std::string image =
      camera(2.0 * std::atan(0.5 * left.width / left.fx), left.width, left.height, 0.05, 60.0);
  out << "<sensor name=\"" << names.stereo << "\" type=\"multicamera\"><always_on>1</always_on>"
      << "<update_rate>" << options.image_rate << "</update_rate><pose>"
      << sensor_pose(robot.stereo_mount.T_BC) << "</pose>\n<camera name=\"left\"><pose>0 0 0 0 0 0"
      << "</pose>" << image << "</camera>\n<camera name=\"right\"><pose>0 "
      << -robot.stereo.baseline << " 0 0 0 0</pose>" << image << "</camera></sensor>\n";
  if (!names.depth.empty()) {
    const double wide = std::tan(0.5 * robot.depth.horizontal_fov);
    const double high = std::tan(0.5 * robot.depth.vertical_fov);
    const double height = std::max(1.0, std::round(options.robot.depth_width * high / wide));
    out << "<sensor name=\"" << names.depth << "\" type=\"depth\"><always_on>1</always_on>"
        << "<update_rate>" << options.depth_rate << "</update_rate><pose>"
        << sensor_pose(robot.depth_mount.T_BC) << "</pose><camera name=\"depth\">"
        << camera(robot.depth.horizontal_fov, options.robot.depth_width, height, 0.05,
                  names.depth_range.max + 1.0)
        << "</camera></sensor>\n";
  }
  out << "</link>\n";
  for (const int sign : {1, -1}) {
    const std::string& wheel = sign > 0 ? names.left_wheel : names.right_wheel;
    out << "<link name=\"" << wheel << "\"><pose>0 " << sign * half << ' ' << r
        << " -1.570796327 0 0</pose>" << inertial(0.0, 0.4, 0.0008, 0.0008, 0.0013)
        << "<collision name=\"tyre\"><geometry><cylinder><radius>" << r
        << "</radius><length>0.03</length></cylinder></geometry><surface><friction><ode><mu>1</mu>"
           "<mu2>1</mu2></ode></friction></surface></collision></link>\n<joint name=\""
        << wheel << "_joint\" type=\"revolute\"><parent>" << names.link << "</parent><child>"
        << wheel << "</child><axis><xyz>0 0 1</xyz></axis></joint>\n";
  }
  out << "<plugin name=\"drive\" filename=\"libDiffDrivePlugin.so\"><left_joint>"
      << names.left_wheel << "_joint</left_joint><right_joint>" << names.right_wheel
      << "_joint</right_joint><torque>5</torque></plugin>\n</model>\n";
  return out.str();
}

std::string sdf(const World& world, const RobotDescription& robot,
                const GazeboWorldOptions& options, const std::string& name) {
  std::ostringstream out = numbers();
  const double top = std::max(options.wall_height, robot.slice().z_max);
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
  out << "</link></model>\n" << robot_model(world, robot, options) << "</world>\n</sdf>\n";
  return out.str();
}

}  // namespace

StereoCamera gazebo_stereo(const StereoCamera& stereo) {
  StereoCamera out = stereo;
  out.left.cx = 0.5 * (stereo.left.width - 1.0);
  out.left.cy = 0.5 * (stereo.left.height - 1.0);
  return out;
}

std::vector<std::pair<std::string, std::string>> gazebo_world_files(
    const World& world, const TexturedMesh& mesh, const RobotDescription& robot,
    const GazeboWorldOptions& options, const std::string& name) {
  check(options.robot);
  const auto positive = [](const char* what, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      refuse(std::string(what) + " is " + std::to_string(value) + "; expected a number > 0");
    }
  };
  positive("image_rate", options.image_rate);
  positive("depth_rate", options.depth_rate);
  positive("depth_width", options.robot.depth_width);
  positive("wall_height", options.wall_height);
  positive("light", options.light.norm());
  if (!(options.ambient >= 0.0 && options.ambient <= 1.0)) refuse("ambient; expected 0..1");
  validate(robot.stereo);
  const PinholeCamera& left = robot.stereo.left;
  if (std::abs(left.fx - left.fy) > 1e-3 * left.fx) {
    refuse("robot.stereo.fx is " + std::to_string(left.fx) + ", fy " + std::to_string(left.fy) +
           "; expected the same, as pixels of Gazebo are square");
  }
  if (mesh.textures.size() * 2 != mesh.triangles.size()) {
    refuse("a mesh that is not one of rectangles; expected that of a world of voxels");
  }
  const Scene scene = scene_of(world, mesh, options, name);
  std::vector<std::pair<std::string, std::string>> files = {{name + ".obj", scene.obj},
                                                            {name + ".mtl", scene.mtl}};
  for (std::size_t n = 0; n < scene.pages.size(); ++n) {
    files.emplace_back(name + "_" + std::to_string(n) + ".png", png(scene.pages[n]));
  }
  files.emplace_back(name + ".sdf", sdf(world, robot, options, name));
  return files;
}

}  // namespace prospect
