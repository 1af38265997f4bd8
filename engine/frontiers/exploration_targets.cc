// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/exploration_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "engine/features/footprint_visibility.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/voxel_grid.h"

namespace prospect {
namespace {

struct Cluster {
  int count = 0;
  double sum_x = 0.0, sum_y = 0.0;
  double best = std::numeric_limits<double>::infinity();  // squared distance to the centroid
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// What is within reach of the robot's cell, in whole blocks of `side` cells, inside the map
/// widened by the band (cells beyond the map are unknown too). None: nothing is.
std::optional<GridFrame> window_about(const Cell& here, const GridFrame& map, int side, int band,
                                      int reach) {
  const int block_i0 = floor_divide(std::max(here.i - reach, map.i0 - band), side);
  const int block_j0 = floor_divide(std::max(here.j - reach, map.j0 - band), side);
  const int block_i1 = floor_divide(std::min(here.i + reach, map.i0 + map.width - 1 + band), side);
  const int block_j1 = floor_divide(std::min(here.j + reach, map.j0 + map.height - 1 + band), side);
  if (block_i1 < block_i0 || block_j1 < block_j0) return std::nullopt;
  return GridFrame{map.resolution, block_i0 * side, block_j0 * side,
                   (block_i1 - block_i0 + 1) * side, (block_j1 - block_j0 + 1) * side};
}

/// Discs of radius `band_cells` around the frontier cells, as differences along the rows of the
/// window, each a number longer than the row: a prefix sum counts the discs over a cell.
std::vector<int> discs_about(const std::vector<Cell>& frontier_cells, const GridFrame& map,
                             const GridFrame& window, double band_cells) {
  const int band = static_cast<int>(std::floor(band_cells));
  std::vector<int> half_width(static_cast<std::size_t>(band) + 1);
  const double band_squared = band_cells * band_cells;
  for (int dj = 0; dj <= band; ++dj) {
    half_width[static_cast<std::size_t>(dj)] =
        static_cast<int>(std::floor(std::sqrt(std::max(0.0, band_squared - dj * dj))));
  }
  const auto row_length = static_cast<std::size_t>(window.width) + 1;
  std::vector<int> starts(row_length * static_cast<std::size_t>(window.height), 0);
  for (const Cell& f : frontier_cells) {
    if (!map.contains(f)) continue;
    for (int dj = -band; dj <= band; ++dj) {
      const int j = f.j + dj - window.j0;
      if (j < 0 || j >= window.height) continue;
      const int w = half_width[static_cast<std::size_t>(std::abs(dj))];
      const int a = std::max(f.i - w - window.i0, 0);
      const int b = std::min(f.i + w - window.i0 + 1, window.width);
      if (a >= b) continue;
      const std::size_t row = row_length * static_cast<std::size_t>(j);
      ++starts[row + static_cast<std::size_t>(a)];
      --starts[row + static_cast<std::size_t>(b)];
    }
  }
  return starts;
}

/// The unexplored cells under discs, by blocks of `side` cells: how many, and that next to their
/// centroid.
Grid<Cluster> clusters_of(const GroundMap& ground, const GridFrame& window,
                          const std::vector<int>& discs, int side) {
  const GridFrame blocks{window.resolution * side, window.i0 / side, window.j0 / side,
                         window.width / side, window.height / side};
  Grid<Cluster> clusters(blocks, Cluster());
  std::vector<Cell> cells;
  const auto row_length = static_cast<std::size_t>(window.width) + 1;
  for (int j = 0; j < window.height; ++j) {
    int depth = 0;
    for (int i = 0; i < window.width; ++i) {
      depth += discs[row_length * static_cast<std::size_t>(j) + static_cast<std::size_t>(i)];
      const Cell c{window.i0 + i, window.j0 + j};
      if (depth <= 0 || ground.explored(c)) continue;
      cells.push_back(c);
      Cluster& cluster = clusters[{floor_divide(c.i, side), floor_divide(c.j, side)}];
      const Eigen::Vector2d p = window.center(c);
      ++cluster.count;
      cluster.sum_x += p.x();
      cluster.sum_y += p.y();
    }
  }
  for (const Cell& c : cells) {
    Cluster& cluster = clusters[{floor_divide(c.i, side), floor_divide(c.j, side)}];
    const Eigen::Vector2d p = window.center(c);
    const Eigen::Vector2d centroid(cluster.sum_x / cluster.count, cluster.sum_y / cluster.count);
    // The margin makes equal distances equal whatever their rounding: the first cell wins.
    const double distance = (p - centroid).squaredNorm();
    if (distance < cluster.best - 1e-9) {
      cluster.best = distance;
      cluster.position = p;
    }
  }
  return clusters;
}

/// Where a sensor is [m].
Eigen::Vector3d place_of(const CameraMount& mount, const Pose& pose) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const Eigen::Vector3d t = mount.T_BC.translation();
  return pose.position + Eigen::Vector3d(c * t.x() - s * t.y(), s * t.x() + c * t.y(), t.z());
}

/// Takes away what a sensor that is mounted `raised` [m] above the targets' sees from where it is.
void drop_visible(const Belief& belief, const DepthSensor& of, double raised,
                  const ExplorationTargetOptions& options, ExplorationTargets& result) {
  const FootprintVisibility view(of.footprint, of.mount);
  const Eigen::Vector3d sensor = place_of(of.mount, belief.pose);
  // The exact ray takes the place of the smoothed one: a table over the present pose alone would
  // cost as much.
  const std::vector<Eigen::Vector3d> positions = result.positions(raised);
  std::vector<VoxelGrid::Ray> rays(positions.size());
  const VoxelGrid& voxels = *belief.voxels;
  voxels.cast_many(sensor, positions.data(), static_cast<int>(positions.size()),
                   1.5 * voxels.resolution(), rays.data());
  std::vector<ExplorationTarget> kept;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double attenuated =
        rays[i].blocked ? 0.0 : std::exp(-options.attenuation * rays[i].unknown_length);
    if (view.in_footprint(belief.pose, positions[i]) * attenuated > options.visible_above) {
      ++result.visible_now;
    } else {
      kept.push_back(result.targets[i]);
    }
  }
  result.targets = std::move(kept);
}

/// Keeps those nearest to the robot or to where it is led, in their order.
void keep_nearest(const Eigen::Vector2d& robot, const ExplorationTargetOptions& options,
                  std::vector<ExplorationTarget>& targets) {
  const auto limit = static_cast<std::size_t>(options.max_targets);
  if (targets.size() <= limit) return;
  std::vector<std::size_t> order(targets.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto distance = [&](std::size_t k) {
    const Eigen::Vector2d p = targets[k].position.head<2>();
    const double to_robot = (p - robot).squaredNorm();
    return options.led_to ? std::min(to_robot, (p - *options.led_to).squaredNorm()) : to_robot;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  order.resize(limit);
  std::sort(order.begin(), order.end());
  std::vector<ExplorationTarget> kept;
  for (const std::size_t i : order) kept.push_back(targets[i]);
  targets = std::move(kept);
}

}  // namespace

std::vector<Eigen::Vector3d> ExplorationTargets::positions(double raised) const {
  std::vector<Eigen::Vector3d> p;
  p.reserve(targets.size());
  for (const ExplorationTarget& t : targets) {
    p.push_back(t.position);
    p.back().z() += raised;
  }
  return p;
}

ExplorationTargets exploration_targets(const Belief& belief,
                                       const std::vector<Cell>& frontier_cells,
                                       const std::vector<DepthSensor>& sensors,
                                       const ExplorationTargetOptions& options) {
  if (!(options.band > 0.0) || !(options.block > 0.0) || options.max_targets < 0 ||
      !(options.reach > 0.0)) {
    throw std::invalid_argument(
        "exploration targets: band, block and reach must be positive [m] and max_targets >= 0");
  }
  ExplorationTargets result;
  result.reference_area = options.reference_min;
  const GroundMap& ground = *belief.ground;
  const GridFrame& map = ground.frame();
  const double r = map.resolution;
  const Eigen::Vector2d robot = belief.pose.position.head<2>();
  if (!robot.allFinite()) return result;

  const int side = std::max(1, static_cast<int>(std::lround(options.block / r)));
  // A whole number of cells must not fall short of itself by rounding.
  const double band_cells = options.band / r + 1e-9;
  const std::optional<GridFrame> window = window_about(
      map.cell(robot.x(), robot.y()), map, side, static_cast<int>(std::floor(band_cells)),
      static_cast<int>(std::ceil(options.reach / r)));
  if (!window) return result;
  const Grid<Cluster> clusters =
      clusters_of(ground, *window, discs_about(frontier_cells, map, *window, band_cells), side);

  const double height = place_of(sensors.front().mount, belief.pose).z();
  for (const Cluster& cluster : clusters.data) {
    if (cluster.count == 0 || (cluster.position - robot).norm() > options.reach) continue;
    result.targets.push_back(
        {{cluster.position.x(), cluster.position.y(), height}, cluster.count * r * r});
  }
  for (const DepthSensor& sensor : sensors) {
    if (!options.drop_visible || result.targets.empty()) break;
    const double raised =
        sensor.mount.T_BC.translation().z() - sensors.front().mount.T_BC.translation().z();
    drop_visible(belief, sensor, raised, options, result);
  }
  double near_mass = 0.0;
  for (const ExplorationTarget& target : result.targets) {
    if ((target.position.head<2>() - robot).norm() <= options.near) near_mass += target.mass;
  }
  result.reference_area = std::clamp(0.5 * near_mass, options.reference_min, options.reference_max);
  keep_nearest(robot, options, result.targets);
  return result;
}

}  // namespace prospect
