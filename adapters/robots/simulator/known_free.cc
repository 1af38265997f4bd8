// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/known_free.h"

#include <algorithm>
#include <cmath>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/sloped_floor.h"
#include "engine/maps/grid.h"

namespace prospect {
namespace {

constexpr double kRounding = 1e-9;  // [m]

/// Whether the columns of the world that meet the inside of a square are all free.
bool free_all_over(const Grid<std::uint8_t>& free, const Eigen::Vector2d& low, double side) {
  const double r = free.frame.resolution;
  const auto first = [r](double x) { return static_cast<int>(std::floor((x + kRounding) / r)); };
  const auto last = [r](double x) { return static_cast<int>(std::ceil((x - kRounding) / r)) - 1; };
  for (int j = first(low.y()); j <= last(low.y() + side); ++j) {
    for (int i = first(low.x()); i <= last(low.x() + side); ++i) {
      if (free.get({i, j}, 0) == 0) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<Disc> known_free(const World& world, const Pose& start, double body_radius,
                             const VerticalExtent& slice, double resolution) {
  const Eigen::Vector2d at = start.position.head<2>();
  const double radius = body_radius + 0.75 * resolution;
  const Grid<std::uint8_t> free = free_columns(*over_the_floor(world, BodySlice{}.step),
                                               {.z_min = slice.z_min, .z_max = slice.z_max});
  const GridFrame& frame = free.frame;
  const Cell own = frame.cell(at.x(), at.y());
  const double wanted = body_radius + resolution;
  const int reach = static_cast<int>(std::ceil(wanted / frame.resolution)) + 1;
  bool roomy = true;
  for (int j = -reach; j <= reach && roomy; ++j) {
    for (int i = -reach; i <= reach && roomy; ++i) {
      if (free.get({own.i + i, own.j + j}, 0) != 0) continue;
      const double x = std::max(0.0, std::abs(i) - 0.5), y = std::max(0.0, std::abs(j) - 0.5);
      roomy = frame.resolution * std::hypot(x, y) > wanted - kRounding;
    }
  }
  if (roomy) return {{at, radius}};

  const int half = static_cast<int>(std::ceil(radius / resolution)) + 1;
  GridFrame cells{resolution, 0, 0, 2 * half + 1, 2 * half + 1};
  const Cell middle = cells.cell(at.x(), at.y());
  cells.i0 = middle.i - half;
  cells.j0 = middle.j - half;
  Grid<std::uint8_t> candidates(cells, 0);
  for (int n = 0; n < cells.size(); ++n) {
    const Cell c = cells.at(n);
    const Eigen::Vector2d center = cells.center(c);
    const Eigen::Vector2d low = center - Eigen::Vector2d::Constant(0.5 * resolution);
    candidates[c] = (center - at).norm() <= radius && free_all_over(free, low, resolution) ? 1 : 0;
  }
  const Grid<std::uint8_t> joined = connected_component(candidates, middle);
  std::vector<Disc> discs;
  for (int n = 0; n < cells.size(); ++n) {
    const Cell c = cells.at(n);
    if (joined[c] != 0) discs.push_back({cells.center(c), 0.25 * resolution});
  }
  return discs;
}

void clear_free(OccupancyMapper& map, const std::vector<Disc>& discs, double z, double height,
                const PlanarMove& to_W) {
  for (const Disc& d : discs) {
    const Eigen::Vector2d at = to_W(d.center);
    map.clear_cylinder({at.x(), at.y(), z}, d.radius, height);
  }
}

}  // namespace prospect
