// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/load_world.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <string_view>
#include <system_error>

#include "adapters/formats/files/extension.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/strict_yaml.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/formats/worlds/cloud_world.h"
#include "adapters/formats/worlds/floor_plan.h"
#include "adapters/formats/worlds/gazebo_world.h"
#include "adapters/formats/worlds/mesh_file.h"
#include "adapters/formats/worlds/mesh_world.h"
#include "adapters/formats/worlds/octree_file.h"
#include "adapters/formats/worlds/octree_world.h"
#include "adapters/formats/worlds/point_cloud_file.h"
#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/ros_map.h"
#include "adapters/formats/worlds/sloped_floor.h"
#include "adapters/formats/worlds/world_file.h"
#include "engine/maps/heading_fit.h"
#include "models/nearest_name.h"

namespace prospect {
namespace {

constexpr const char* kExtensions =
    ".yaml, .bt, .ot, .pgm, .png, .bmp, .map, .obj, .dae, .gltf, .glb, .stl, .ply, .pcd, .world, "
    ".sdf";

/// Distance [m] from a column's centre to the nearest column that is not free, at most `bound`.
double clearance(const Grid<std::uint8_t>& free, Cell c, double bound) {
  const double r = free.frame.resolution;
  if (free.get(c, 0) == 0) return 0.0;
  double nearest = bound / r;
  for (int ring = 1; ring - 0.5 < nearest; ++ring) {
    for (int dj = -ring; dj <= ring; ++dj) {
      const int step = std::abs(dj) == ring ? 1 : 2 * ring;
      for (int di = -ring; di <= ring; di += step) {
        if (free.get({c.i + di, c.j + dj}, 0) != 0) continue;
        nearest = std::min(nearest, std::hypot(std::max(std::abs(di) - 0.5, 0.0),
                                               std::max(std::abs(dj) - 0.5, 0.0)));
      }
    }
  }
  return nearest * r;
}

std::string number(double value) {
  std::ostringstream out;
  out.precision(4);
  out << value;
  return out.str();
}

/// Whether the body's ground outline at a pose meets no column that is not free.
bool fits_at(const Grid<std::uint8_t>& free, const RobotShape& shape, const Pose& pose) {
  constexpr double kTouch = 1e-9;  // [m]
  const GridFrame& frame = free.frame;
  const std::vector<OutlinePart> outline = ground_outline(shape);
  const Eigen::Vector2d at = pose.position.head<2>();
  const Cell own = frame.cell(at.x(), at.y());
  const int reach = static_cast<int>(std::ceil(circumscribed_radius(shape) / frame.resolution)) + 1;
  for (int j = own.j - reach; j <= own.j + reach; ++j) {
    for (int i = own.i - reach; i <= own.i + reach; ++i) {
      if (free.get({i, j}, 0) != 0) continue;
      const Eigen::Vector2d low(i * frame.resolution, j * frame.resolution);
      if (outline_distance(outline, at, pose.yaw, low, frame.resolution) < -kTouch) return false;
    }
  }
  return free.get(own, 0) != 0;
}

[[noreturn]] void cannot_stand(const World& world, const BodySlice& slice,
                               const Eigen::Vector3d& at) {
  const GridFrame& frame = world.voxels.frame();
  const Cell cell = frame.cell(at.x(), at.y());
  std::string what;
  if (!frame.contains(cell)) {
    what = "lies outside the map";
  } else {
    const double room = clearance(free_columns(world.voxels, slice), cell, 10.0);
    what =
        room > 0.0 ? "has " + number(room) + " m of room" : "lies inside a wall or unknown space";
  }
  throw InputError(
      world.name + ": the start (" + number(at.x()) + ", " + number(at.y()) + ") " + what +
      "; expected a place where the body touches nothing that is not free, at " + "its heading");
}

Pose default_start(const World& world, const BodySlice& slice, const Grid<std::uint8_t>& standing) {
  const GridFrame& frame = standing.frame;
  Grid<std::uint8_t> rest = standing;
  Grid<std::uint8_t> largest(frame, 0);
  std::ptrdiff_t most = 0;
  for (int n = 0; n < frame.size(); ++n) {
    if (rest.data[static_cast<std::size_t>(n)] == 0) continue;
    // Flood in place: what has been counted is taken out of the rest.
    std::vector<Cell> open{frame.at(n)};
    std::vector<Cell> members;
    rest[open.front()] = 0;
    while (!open.empty()) {
      const Cell c = open.back();
      open.pop_back();
      members.push_back(c);
      for (const Cell d : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
        const Cell next{c.i + d.i, c.j + d.j};
        if (rest.get(next, 0) == 0) continue;
        rest[next] = 0;
        open.push_back(next);
      }
    }
    if (static_cast<std::ptrdiff_t>(members.size()) > most) {
      most = static_cast<std::ptrdiff_t>(members.size());
      std::fill(largest.data.begin(), largest.data.end(), std::uint8_t{0});
      for (const Cell& c : members) largest[c] = 1;
    }
  }
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (int n = 0; n < frame.size(); ++n) {
    if (largest.data[static_cast<std::size_t>(n)] != 0) centroid += frame.center(frame.at(n));
  }
  centroid /= static_cast<double>(most);
  const auto nearest_to = [&](const Eigen::Vector2d& p) {
    Cell best;
    double distance = std::numeric_limits<double>::infinity();
    for (int n = 0; n < frame.size(); ++n) {
      if (largest.data[static_cast<std::size_t>(n)] == 0) continue;
      const double d = (frame.center(frame.at(n)) - p).squaredNorm();
      if (d < distance) {
        distance = d;
        best = frame.at(n);
      }
    }
    return best;
  };
  const Cell middle = nearest_to(centroid);
  const Grid<std::uint8_t> free = free_columns(world.voxels, slice);
  Cell best = middle;
  double most_room = -1.0;
  int nearest = 0;
  const int reach = static_cast<int>(1.0 / frame.resolution);
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      const Cell c{middle.i + di, middle.j + dj};
      const int distance = di * di + dj * dj;
      if (distance > reach * reach || largest.get(c, 0) == 0) continue;
      const double room = clearance(free, c, 3.0);
      if (room < most_room || (room == most_room && distance >= nearest)) continue;
      most_room = room;
      nearest = distance;
      best = c;
    }
  }
  Pose start;
  start.position.head<2>() = frame.center(best);
  return start;
}

/// A ROS map has an image, or at least what no world file has; the strict readers tell what else is
/// wrong.
bool is_ros_map(const std::string& path) {
  StrictYaml yaml = StrictYaml::from_file(path);
  const YamlMap root = yaml.root();
  if (root.has("image")) return true;
  return !root.has("rooms") && !root.has("textures") &&
         (root.has("occupied_thresh") || root.has("free_thresh") || root.has("origin"));
}

struct FloorPlanChoice {
  std::uint64_t seed = 0;
  std::optional<FloorPlanSize> size;
  PlanFloor floor = PlanFloor::kFlat;
};

/// Of "plan:SEED" or "plan:SEED:COLUMNSxROWS", or "drops:" or "ramps:" and the same; none: the name
/// is none of a floor plan.
std::optional<FloorPlanChoice> floor_plan_choice(const std::string& name) {
  constexpr int kLeast = 2, kMost = 40;
  FloorPlanChoice choice;
  std::string kind;
  for (const PlanFloor floor : {PlanFloor::kFlat, PlanFloor::kDrops, PlanFloor::kRamps}) {
    if (!name.starts_with(std::string(kind_of(floor)) + ':')) continue;
    choice.floor = floor;
    kind = kind_of(floor);
  }
  if (kind.empty()) return std::nullopt;
  const char* at = name.data() + kind.size() + 1;
  const char* const last = name.data() + name.size();
  // Reads a number; false if there is none.
  const auto number = [&](auto& value) {
    const auto [end, wrong] = std::from_chars(at, last, value);
    at = end;
    return wrong == std::errc();
  };
  const auto passed = [&](char c) { return at != last && *at++ == c; };
  if (!number(choice.seed) || (at != last && *at != ':')) {
    throw InputError("world '" + name + "': no seed; expected " + kind + ":SEED, e.g. " + kind +
                     ":7");
  }
  if (at == last) return choice;
  FloorPlanSize size;
  const bool given =
      passed(':') && number(size.columns) && passed('x') && number(size.rows) && at == last;
  if (!given || std::min(size.columns, size.rows) < kLeast ||
      std::max(size.columns, size.rows) > kMost) {
    throw InputError("world '" + name + "': no size; expected " + kind +
                     ":SEED:COLUMNSxROWS of 2 to 40 rooms each, "
                     "e.g. " +
                     kind + ":7:8x6");
  }
  choice.size = size;
  return choice;
}

bool is_one_of(const std::string& text, std::initializer_list<const char*> choices) {
  return std::find(choices.begin(), choices.end(), text) != choices.end();
}

/// A world file says all of this itself.
void refuse_for_world_file(const std::string& name, const WorldOptions& options) {
  const char* option = options.voxel_size > 0.0      ? "--resolution or world.resolution"
                       : options.unknown_is_free     ? "--unknown or world.unknown"
                       : options.floor               ? "--floor or world.floor"
                       : options.ground_margin > 0.0 ? "--ground or world.ground"
                       : options.up                  ? "--up or world.up"
                                                     : nullptr;
  if (option == nullptr) return;
  throw InputError(name + ": a world file says that itself; expected no " + option);
}

}  // namespace

void place_start(World& world, const BodySlice& slice, const std::optional<Pose>& given,
                 bool world_states_start) {
  if (!world.slopes.empty()) {
    World flat = flattened(world, slice.step);
    place_start(flat, slice, given, world_states_start);
    world.start = flat.start;
    return;
  }
  if (given) {
    constexpr double kFarthest = 1e6;  // [m]; beyond it a cell's address would overflow
    const bool sound = given->position.allFinite() && std::isfinite(given->yaw) &&
                       given->position.cwiseAbs().maxCoeff() < kFarthest;
    if (!sound) {
      throw InputError(world.name + ": the start is not finite; expected x, y [m] and yaw [rad]");
    }
    world.start = *given;
    world.start.position.z() = 0.0;
  }
  if (given || world_states_start) {
    if (!fits_at(free_columns(world.voxels, slice), slice.shape, world.start)) {
      cannot_stand(world, slice, world.start.position);
    }
    return;
  }
  const auto any = [](const Grid<std::uint8_t>& mask) {
    return std::find(mask.data.begin(), mask.data.end(), 1) != mask.data.end();
  };
  const Grid<std::uint8_t> standing = standing_columns(world.voxels, slice);
  if (any(standing)) {
    world.start = default_start(world, slice, standing);
    return;
  }
  const Grid<HeadingMask> headings = fitting_headings(world.voxels, slice, 0.0);
  Grid<std::uint8_t> fits(headings.frame, 0);
  for (std::size_t n = 0; n < fits.data.size(); ++n) fits.data[n] = headings.data[n] != kNoHeading;
  if (any(fits)) world.start = default_start(world, slice, fits);
  // A spot that it could not leave is no place to explore from, unless it is asked for.
  constexpr double kLeastRoom = 0.1;  // [m^2]
  const Cell at = fits.frame.cell(world.start.position.x(), world.start.position.y());
  const Grid<std::uint8_t> around = connected_component(fits, at);
  const double cells = static_cast<double>(std::count(around.data.begin(), around.data.end(), 1));
  if (!any(fits) || cells * fits.frame.resolution * fits.frame.resolution < kLeastRoom) {
    const double top = (world.voxels.k0() + world.voxels.depth()) * world.voxels.resolution();
    throw InputError(
        world.name +
        ": no place where the robot can stand (the map reaches up to z = " + number(top) +
        " m); expected free space for the body, of " + number(circumscribed_radius(slice.shape)) +
        " m around its origin, from z = " + number(slice.z_min) + " to " + number(slice.z_max) +
        " m" + (world.if_no_room.empty() ? "" : "; " + world.if_no_room));
  }
  const HeadingMask there =
      headings[headings.frame.cell(world.start.position.x(), world.start.position.y())];
  int off = 0;  // headings 0, 1, -1, 2, -2 ...
  while (((there >> ((off + kHeadings) % kHeadings)) & 1U) == 0) off = off > 0 ? -off : 1 - off;
  world.start.yaw = std::remainder(heading_at((off + kHeadings) % kHeadings), 2.0 * M_PI);
}

World load_world(const std::string& name_or_path, const WorldOptions& options) {
  namespace fs = std::filesystem;
  const std::vector<std::string> names = builtin_world_names();
  bool states_start = false;
  std::error_code error;
  std::optional<World> world;
  bool cloud = false;
  if (std::find(names.begin(), names.end(), name_or_path) != names.end() ||
      floor_plan_choice(name_or_path)) {
    refuse_for_world_file(name_or_path, options);
  }
  if (std::find(names.begin(), names.end(), name_or_path) != names.end()) {
    world = world_from_yaml(builtin_world_text(name_or_path), "built-in " + name_or_path,
                            &states_start);
  } else if (const std::optional<FloorPlanChoice> plan = floor_plan_choice(name_or_path)) {
    world = world_from_yaml(random_floor_plan(plan->seed, plan->size, plan->floor), name_or_path,
                            &states_start);
  } else {
    const fs::path path(name_or_path);
    const std::string extension = lower_case_extension(path);
    if (!fs::exists(path, error)) {
      const bool like_a_path = !extension.empty() || name_or_path.find('/') != std::string::npos;
      std::string list;
      for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
      throw InputError(like_a_path
                           ? name_or_path + ": no such file; expected a world: " + kExtensions
                           : "unknown world '" + name_or_path + "'" +
                                 did_you_mean(name_or_path, names) + "; expected one of: " + list +
                                 ", plan:SEED, drops:SEED, ramps:SEED, or a file");
    }
    if (fs::is_directory(path, error)) {
      throw InputError(name_or_path + ": is a directory; expected a world: " + kExtensions);
    }
    if (!fs::is_regular_file(path, error)) {
      throw InputError(name_or_path + ": is not a regular file; expected a world: " + kExtensions);
    }
    cloud = is_point_cloud_file(name_or_path);
    const bool mesh = !cloud && is_mesh_file(name_or_path);
    const bool gazebo = is_one_of(extension, {".world", ".sdf"});
    const bool octree = is_one_of(extension, {".bt", ".ot"});
    if (options.floor && !mesh && !gazebo && !octree && !cloud) {
      throw InputError(name_or_path + ": has one storey; expected no --floor or world.floor");
    }
    if (options.ground_margin > 0.0 && !mesh && !gazebo) {
      throw InputError(name_or_path +
                       ": has no ground without end; expected no --ground or world.ground");
    }
    if (options.up && !mesh && !cloud) {
      throw InputError(name_or_path + ": is upright by itself; expected no --up or world.up");
    }
    if (octree) {
      OctreeWorldOptions octree_options;
      octree_options.resolution =
          options.voxel_size > 0.0 ? options.voxel_size : options.resolution;
      octree_options.ground = options.floor;
      octree_options.unknown_is_free = options.unknown_is_free;
      LeftOut left_out;
      const auto tree = read_octree(name_or_path, {}, &left_out);
      if (options.voxel_size > 0.0 && options.voxel_size < 0.99 * tree->getResolution()) {
        throw InputError(name_or_path + ": voxels of " + number(tree->getResolution()) +
                         " m; expected a resolution of at least that");
      }
      world = world_from_octree(*tree, name_or_path, octree_options);
      world->left_out.add(left_out);
    } else if (extension == ".yaml" || extension == ".yml") {
      if (is_ros_map(name_or_path)) {
        world = world_from_ros_map(name_or_path, options);
      } else {
        refuse_for_world_file(name_or_path, options);
        world = world_from_file(name_or_path, &states_start);
      }
    } else if (is_one_of(extension, {".pgm", ".png", ".bmp", ".ppm", ".pbm", ".pnm"})) {
      world = world_from_image(name_or_path, options);
    } else if (extension == ".map") {
      world = world_from_movingai(name_or_path, options);
    } else if (cloud) {
      CloudWorldOptions cloud_options;
      cloud_options.resolution = options.voxel_size;
      cloud_options.up = options.up.value_or(UpAxis::kZ);
      cloud_options.ground = options.floor;
      cloud_options.unknown_is_free = options.unknown_is_free;
      cloud_options.progress = options.progress;
      world = world_from_cloud(read_point_cloud(name_or_path, options.progress), name_or_path,
                               cloud_options);
    } else if (mesh || gazebo) {
      MeshWorldOptions mesh_options;
      if (options.voxel_size > 0.0) mesh_options.resolution = options.voxel_size;
      mesh_options.ground = options.floor;
      mesh_options.ground_margin = options.ground_margin;
      mesh_options.unknown_is_free = options.unknown_is_free;
      mesh_options.progress = options.progress;
      mesh_options.places = options.places;
      if (options.start) mesh_options.places.emplace_back(options.start->position.head<2>());
      world = world_from_mesh(
          mesh ? read_mesh_file(name_or_path, UpAxis::kY, {}, options.progress, options.up)
               : read_gazebo_world(name_or_path, options.progress),
          name_or_path, mesh_options);
      if (is_one_of(extension, {".obj", ".stl", ".ply"})) world->assumed = "metres";
    } else {
      throw InputError(name_or_path + ": unknown kind of file '" + extension +
                       "'; expected one of " + kExtensions);
    }
    world->name = path.stem().string();
  }
  place_start(*world, options.slice, options.start, states_start);
  if (world->mesh != nullptr || cloud) keep_connected_space(*world);
  return *std::move(world);
}

}  // namespace prospect
