// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/mesh_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/worlds/left_out.h"

namespace prospect {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

/// Whether a triangle and a box have a point in common (separating axes: Akenine-Moeller, 2001).
bool touches(const Corners& triangle, const Vector3d& centre, const Vector3d& half) {
  const Corners v = {triangle[0] - centre, triangle[1] - centre, triangle[2] - centre};
  const auto separates = [&](const Vector3d& axis) {
    const double a = axis.dot(v[0]), b = axis.dot(v[1]), c = axis.dot(v[2]);
    const double reach = half.dot(axis.cwiseAbs());
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  for (int k = 0; k < 3; ++k) {
    if (separates(Vector3d::Unit(k))) return false;
  }
  const Corners edges = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  if (separates(edges[0].cross(edges[1]))) return false;
  for (const Vector3d& edge : edges) {
    for (int k = 0; k < 3; ++k) {
      if (separates(edge.cross(Vector3d::Unit(k)))) return false;
    }
  }
  return true;
}

Corners corners_of(const TexturedMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return {mesh.vertices[triangle[0]].cast<double>(), mesh.vertices[triangle[1]].cast<double>(),
          mesh.vertices[triangle[2]].cast<double>()};
}

struct MeshFloor {
  double height = 0.0;  ///< [m] of the floor
  double share = 0.0;   ///< World::floor_share
};

/// Of the box about all triangles that are steeper than 45 degrees [m^2]; infinite if there is
/// none.
double walled_area(const TexturedMesh& mesh) {
  Eigen::AlignedBox2d box;
  for (const auto& triangle : mesh.triangles) {
    const Corners c = corners_of(mesh, triangle);
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
    if (std::abs(normal.z()) > normal.head<2>().norm()) continue;
    for (const Vector3d& p : c) box.extend(Eigen::Vector2d(p.head<2>()));
  }
  return box.isEmpty() ? std::numeric_limits<double>::infinity() : box.sizes().prod();
}

/// The floor, as world_from_mesh() says.
MeshFloor mesh_floor(const TexturedMesh& mesh, const std::string& name,
                     const std::optional<double>& wanted) {
  constexpr double kStep = 0.05;        // [m]
  constexpr double kLevel = 0.984808;   // cos 10 degrees
  constexpr double kGround = 0.707107;  // cos 45 degrees: what can be meant to be stood on
  struct Layer {
    double area = 0.0, moment = 0.0;  // moment: area times height
    double height() const { return moment / area; }
  };
  const double walled = walled_area(mesh);
  for (const double side : {1.0, -1.0}) {
    std::map<int, Layer> layers, all;
    for (const auto& triangle : mesh.triangles) {
      const Corners c = corners_of(mesh, triangle);
      const Vector3d normal = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
      const double area = normal.norm();
      if (!(area > 0.0) || side * normal.z() < kGround * area) continue;
      const double height = (c[0].z() + c[1].z() + c[2].z()) / 3.0;
      const int step = static_cast<int>(std::floor(height / kStep));
      all[step].area += area;
      all[step].moment += area * height;
      if (side * normal.z() < kLevel * area) continue;
      layers[step].area += area;
      layers[step].moment += area * height;
    }
    if (layers.empty()) continue;
    double most = 0.0;
    for (const auto& [step, layer] : layers) most = std::max(most, layer.area);
    const Layer* floor = nullptr;
    if (wanted) {
      constexpr double kFarthest = 0.5;  // [m]
      // Of a plane without end under a building no more counts than lies about the building.
      const auto counted = [&](const Layer& layer) { return std::min(layer.area, walled); };
      const double least = 0.05 * std::min(most, walled);
      double largest = least;
      for (const auto& [step, layer] : layers) {
        const bool near = std::abs(layer.height() - *wanted) <= kFarthest;
        if (near) largest = std::max(largest, counted(layer));
      }
      double nearest = kFarthest;
      for (const auto& [step, layer] : layers) {
        const double off = std::abs(layer.height() - *wanted);
        if (off > nearest || counted(layer) < std::max(0.5 * largest, least)) continue;
        nearest = off;
        floor = &layer;
      }
    } else {
      for (const auto& [step, layer] : layers) {
        if (layer.area >= 0.5 * most && floor == nullptr) floor = &layer;
      }
    }
    if (floor == nullptr) {
      std::string heights;
      for (const auto& [step, layer] : layers) {
        if (layer.area < 0.2 * most || heights.size() > 100) continue;
        heights += (heights.empty() ? "" : ", ") + metres(layer.height());
      }
      throw InputError(name + ": no ground within 0.5 m of z = " + metres(*wanted) +
                       " m; expected one of the heights " + heights + " m");
    }
    constexpr double kThickness = 0.1, kAround = 1.0;  // [m]
    double at_floor = 0.0, around = 0.0, total = 0.0;
    for (const auto& [step, layer] : all) {
      const double off = std::abs(layer.height() - floor->height());
      total += layer.area;
      if (off <= kAround) around += layer.area;
      if (off <= kThickness) at_floor += layer.area;
    }
    constexpr double kLeast = 1.0 / 3.0;
    if (!wanted && at_floor < kLeast * around) {
      throw InputError(name + ": the ground is not flat: only " +
                       metres(100.0 * at_floor / around) +
                       " % of it is within 0.1 m of z = " + metres(floor->height()) +
                       " m; expected a flat floor, or --floor with the "
                       "height to explore at");
    }
    return {floor->height(), at_floor / total};
  }
  throw InputError(
      name +
      ": nothing level in the mesh; expected a floor, z up (of a mesh --up says another axis)");
}

/// Tells if the mesh seems to lie on its side, as world_from_mesh() says.
void tell_if_on_its_side(TexturedMesh& mesh) {
  constexpr double kFacing = 0.984808;  // cos 10 degrees
  constexpr double kWider = 1.5, kFlatter = 0.5;
  Vector3d area = Vector3d::Zero();
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    const Corners c = corners_of(mesh, triangle);
    const Vector3d normal = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
    for (const Vector3d& p : c) box.extend(p);
    for (int k = 0; k < 3; ++k) {
      if (std::abs(normal[k]) > kFacing * normal.norm()) area[k] += normal.norm();
    }
  }
  const int axis = area.x() > area.y() ? 0 : 1;
  if (area[axis] <= kWider * area.z() || box.sizes()[axis] >= kFlatter * box.sizes().z()) return;
  const std::string name(1, "xy"[axis]);
  mesh.left_out.name("a floor wider than the walls (" + metres(area.z()) + " m2 are level, " +
                     metres(area[axis]) + " m2 face " + name +
                     ": it seems to lie on its side; of a mesh --up " + name + " sets it upright)");
}

/// What of the ground counts, as world_from_mesh() says; told if that is not all. Floor at z = 0.
Eigen::AlignedBox2d extent_of(TexturedMesh& mesh, const MeshWorldOptions& options) {
  constexpr double kRise = 0.15;          // [m]
  constexpr double kLargest = 1000.0;     // [m^2]
  constexpr double kNarrow = 3.0;         // [m]
  constexpr double kLeastMargin = 5.0;    // [m] about what is narrower
  constexpr double kAroundOrigin = 10.0;  // [m]
  constexpr double kThickness = 0.05;     // [m] of a level
  constexpr double kWide = 0.1;           // of the area of the whole: a triangle of the plane
  const auto top = [](const Corners& c) { return std::max({c[0].z(), c[1].z(), c[2].z()}); };
  const auto box = [](const Corners& c) {
    Eigen::AlignedBox2d of;
    for (const Vector3d& p : c) of.extend(Eigen::Vector2d(p.head<2>()));
    return of;
  };
  Eigen::AlignedBox2d whole, rising;
  for (const auto& triangle : mesh.triangles) whole.extend(box(corners_of(mesh, triangle)));
  double plane = -std::numeric_limits<double>::infinity();  // the highest, not above the floor
  for (const auto& triangle : mesh.triangles) {
    const Corners corners = corners_of(mesh, triangle);
    const bool wide = box(corners).sizes().prod() >= kWide * whole.sizes().prod();
    if (wide && top(corners) <= kThickness) plane = std::max(plane, top(corners));
  }
  plane = std::isfinite(plane) ? std::min(plane, 0.0) : 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Corners corners = corners_of(mesh, triangle);
    if (top(corners) > plane + kRise) rising.extend(box(corners));
  }
  const double area = whole.sizes().prod();
  if (area <= kLargest || (!rising.isEmpty() && 2.0 * rising.sizes().prod() >= area)) return whole;
  double margin = options.ground_margin;
  if (rising.isEmpty()) {
    const Eigen::Vector2d origin = Eigen::Vector2d::Zero();
    rising.extend(whole.contains(origin) ? origin : Eigen::Vector2d(whole.center()));
    margin = std::max(margin, kAroundOrigin);
  } else if (rising.sizes().minCoeff() < kNarrow) {
    margin = std::max(margin, kLeastMargin);
  }
  rising.min().array() -= margin;
  rising.max().array() += margin;
  for (const Eigen::Vector2d& place : options.places) {
    if (!whole.contains(place)) continue;
    for (const double side : {-2.0, 2.0}) rising.extend(Eigen::Vector2d(place.array() + side));
  }
  const Eigen::AlignedBox2d counted = rising.intersection(whole);
  if (2.0 * counted.sizes().prod() >= area) return whole;
  mesh.left_out.name("the ground beyond x " + metres(counted.min().x()) + " to " +
                     metres(counted.max().x()) + ", y " + metres(counted.min().y()) + " to " +
                     metres(counted.max().y()) + " m (of " + metres(whole.sizes().x()) + " x " +
                     metres(whole.sizes().y()) + " m; --ground takes more)");
  return counted;
}

}  // namespace

World world_from_mesh(TexturedMesh mesh, const std::string& name, const MeshWorldOptions& options) {
  const double r = options.resolution;
  constexpr double kFarthest = 1e5;  // [m]; beyond, addresses of voxels could overflow
  for (const Eigen::Vector3f& p : mesh.vertices) {
    if (!(p.cwiseAbs().maxCoeff() <= static_cast<float>(kFarthest))) {
      throw InputError(name + ": a vertex at (" + metres(p.x()) + ", " + metres(p.y()) + ", " +
                       metres(p.z()) + ") m; expected all within 100 km of the origin");
    }
  }
  const MeshFloor ground = mesh_floor(mesh, name, options.ground);
  const double floor = ground.height;
  for (Eigen::Vector3f& p : mesh.vertices) p.z() = static_cast<float>(p.z() - floor);
  tell_if_on_its_side(mesh);
  const Eigen::AlignedBox2d box = extent_of(mesh, options);
  const double columns = std::ceil(box.sizes().x() / r) + 2.0,
               rows = std::ceil(box.sizes().y() / r) + 2.0;
  const int top = static_cast<int>(std::ceil(options.height / r));  // voxels above the floor
  const double voxels = columns * rows * (top + 1);
  if (!(voxels <= static_cast<double>(options.max_voxels))) {
    throw InputError(name + ": " + metres(box.sizes().x()) + " x " + metres(box.sizes().y()) +
                     " m are too many voxels of " + metres(r) +
                     " m; expected a mesh in metres, of a building");
  }
  const GridFrame frame{r, static_cast<int>(std::floor(box.min().x() / r)),
                        static_cast<int>(std::floor(box.min().y() / r)), static_cast<int>(columns),
                        static_cast<int>(rows)};
  const int depth = top + 1;
  constexpr int kLowest = -1;
  const auto index = [&](int i, int j, int k) {
    return static_cast<std::size_t>(frame.index({i, j})) * static_cast<std::size_t>(depth) +
           static_cast<std::size_t>(k - kLowest);
  };
  std::vector<CellState> data(
      static_cast<std::size_t>(frame.size()) * static_cast<std::size_t>(depth),
      CellState::kUnknown);
  // The slab of layer k: that of the floor reaches up by the tolerance and down to where floors
  // lie.
  const double below = std::max(r, 0.1);
  const auto slab = [&](int k) -> std::pair<double, double> {
    if (k == kLowest) return {-below, options.floor_tolerance};
    return {std::max(k * r, options.floor_tolerance), (k + 1) * r};
  };
  // A face between two voxels belongs to the one above, by the range of cells; rounding must not
  // take it from that one, too.
  constexpr double kRounding = 1e-6;
  constexpr double kMostTests = 3e9;  // a minute
  double tests = 0.0;
  constexpr std::size_t kTold = 1024;  // triangles
  std::size_t done = 0;
  for (const auto& triangle : mesh.triangles) {
    if (options.progress && done++ % kTold == 0) {
      options.progress("voxels of " + name + ": " + std::to_string(done - 1) + " of " +
                       std::to_string(mesh.triangles.size()) + " triangles");
    }
    const Corners corners = corners_of(mesh, triangle);
    Eigen::AlignedBox3d bounds;
    for (const Vector3d& p : corners) bounds.extend(p);
    if (bounds.max().z() < -below || bounds.min().z() > top * r) continue;
    const auto cell = [&](double x) { return static_cast<int>(std::floor(x / r)); };
    const int k0 = bounds.min().z() <= options.floor_tolerance ? kLowest : cell(bounds.min().z());
    const int k1 = std::min(top - 1, std::max(kLowest, cell(std::min(bounds.max().z(), top * r))));
    const int i0 = std::max(cell(bounds.min().x()), frame.i0);
    const int i1 = std::min(cell(bounds.max().x()), frame.i0 + frame.width - 1);
    const int j0 = std::max(cell(bounds.min().y()), frame.j0);
    const int j1 = std::min(cell(bounds.max().y()), frame.j0 + frame.height - 1);
    if (i1 < i0 || j1 < j0 || k1 < k0) continue;
    tests += static_cast<double>(i1 - i0 + 1) * (j1 - j0 + 1) * (k1 - k0 + 1);
    if (tests > kMostTests) {
      throw InputError(name + ": its triangles lie in more than " + metres(kMostTests) +
                       " voxels, counted one by one; expected a mesh of a building");
    }
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        for (int k = k0; k <= k1; ++k) {
          CellState& state = data[index(i, j, k)];
          const auto [low, high] = slab(k);
          if (state == CellState::kOccupied || !(low < high)) continue;
          const Vector3d centre((i + 0.5) * r, (j + 0.5) * r, 0.5 * (low + high));
          const Vector3d half(0.5 * r, 0.5 * r, 0.5 * (high - low));
          if (touches(corners, centre, half.array() + kRounding)) {
            state = CellState::kOccupied;
          }
        }
      }
    }
  }
  for (int j = frame.j0; j < frame.j0 + frame.height; ++j) {
    for (int i = frame.i0; i < frame.i0 + frame.width; ++i) {
      CellState& below_floor = data[index(i, j, kLowest)];
      if (options.unknown_is_free && below_floor == CellState::kUnknown) {
        below_floor = CellState::kOccupied;
      }
      if (below_floor != CellState::kOccupied) continue;
      for (int k = 0; k < top; ++k) {
        CellState& state = data[index(i, j, k)];
        if (state == CellState::kUnknown) state = CellState::kFree;
      }
    }
  }
  LeftOut left_out = mesh.left_out;
  return World{.name = name,
               .voxels = VoxelGrid(frame, kLowest, depth, std::move(data)),
               .start = {},
               .texture_density = {},
               .texture_class = {},
               .source_floor_height = floor,
               .mesh = std::make_shared<const TexturedMesh>(std::move(mesh)),
               .left_out = std::move(left_out),
               .floor_share = ground.share};
}

void keep_connected_space(World& world) {
  const VoxelGrid& voxels = world.voxels;
  const GridFrame& frame = voxels.frame();
  const int depth = voxels.depth();
  std::vector<CellState> data = voxels.data();
  std::vector<std::uint8_t> connected(data.size(), 0);
  std::vector<std::size_t> open;
  const auto visit = [&](std::size_t n) {
    if (data[n] != CellState::kFree || connected[n] != 0) return;
    connected[n] = 1;
    open.push_back(n);
  };
  const Cell start = frame.cell(world.start.position.x(), world.start.position.y());
  if (frame.contains(start)) {
    const std::size_t column =
        static_cast<std::size_t>(frame.index(start)) * static_cast<std::size_t>(depth);
    for (std::size_t n = 0; n < static_cast<std::size_t>(depth); ++n) visit(column + n);
  }
  while (!open.empty()) {
    const std::size_t n = open.back();
    open.pop_back();
    const auto layer = static_cast<int>(n % static_cast<std::size_t>(depth));
    const Cell cell = frame.at(static_cast<int>(n / static_cast<std::size_t>(depth)));
    if (layer > 0) visit(n - 1);
    if (layer + 1 < depth) visit(n + 1);
    for (const Cell& next : {Cell{cell.i + 1, cell.j}, Cell{cell.i - 1, cell.j},
                             Cell{cell.i, cell.j + 1}, Cell{cell.i, cell.j - 1}}) {
      if (!frame.contains(next)) continue;
      visit(static_cast<std::size_t>(frame.index(next)) * static_cast<std::size_t>(depth) +
            static_cast<std::size_t>(layer));
    }
  }
  for (std::size_t n = 0; n < data.size(); ++n) {
    if (data[n] == CellState::kFree && connected[n] == 0) data[n] = CellState::kUnknown;
  }
  world.voxels = VoxelGrid(frame, voxels.k0(), depth, std::move(data));
}

}  // namespace prospect
