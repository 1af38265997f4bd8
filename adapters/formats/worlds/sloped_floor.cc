// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/worlds/sloped_floor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "perception/mapping/floor_join.h"

namespace prospect {
namespace {

/// The highest slope at a place; null: none.
const Slope* slope_at(const World& world, const Eigen::Vector2d& p) {
  const Slope* top = nullptr;
  for (const Slope& slope : world.slopes) {
    if (slope.contains(p) && (top == nullptr || slope.at(p) > top->at(p))) top = &slope;
  }
  return top;
}

/// Whether a slope alone is more than a robot gets up.
bool is_too_steep(const Slope& slope, double step) {
  const double whole = slope.rise.cwiseAbs().dot(slope.high - slope.low);
  return slope.rise.norm() > kSteepest + 1e-6 && whole > step;
}

}  // namespace

double floor_height(const World& world, const Eigen::Vector2d& p) {
  const Slope* slope = slope_at(world, p);
  return slope != nullptr ? slope->at(p) : 0.0;
}

Standing standing(const World& world, const Eigen::Vector2d& at, double yaw) {
  Standing result;
  if (world.slopes.empty()) return result;
  constexpr int kPoints = 8;
  double sum = 0.0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  // in B
  for (int n = 0; n < kPoints; ++n) {
    const double angle = 2.0 * M_PI * n / kPoints;
    const Eigen::Vector2d around(std::cos(angle), std::sin(angle));
    const double z =
        floor_height(world, at + Standing::kWheels * (Eigen::Rotation2Dd(yaw) * around));
    sum += z;
    gradient += 2.0 / (kPoints * Standing::kWheels) * z * around;
  }
  result.height = sum / kPoints;
  const Eigen::Vector3d up = Eigen::Vector3d(-gradient.x(), -gradient.y(), 1.0).normalized();
  result.tilt = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up).toRotationMatrix();
  return result;
}

double distance_to_slopes(std::span<const Slope> slopes, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Slope& slope : slopes) {
    // The part of the ray over the rectangle, and within it the part below the top.
    double begin = 0.0, end = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 2; ++a) {
      if (direction[a] == 0.0) {
        if (from[a] < slope.low[a] || from[a] >= slope.high[a]) end = -1.0;
        continue;
      }
      const double one = (slope.low[a] - from[a]) / direction[a];
      const double other = (slope.high[a] - from[a]) / direction[a];
      begin = std::max(begin, std::min(one, other));
      end = std::min(end, std::max(one, other));
    }
    if (!(begin <= end)) continue;
    const double above = from.z() - slope.at(from.head<2>());
    const double climbs = direction.z() - slope.rise.dot(direction.head<2>());
    if (above + climbs * begin <= 0.0) {
      nearest = std::min(nearest, begin);
    } else if (climbs < 0.0 && -above / climbs <= end) {
      nearest = std::min(nearest, -above / climbs);
    }
  }
  return nearest;
}

Grid<int> floor_levels(const World& world) {
  const GridFrame& frame = world.voxels.frame();
  Grid<int> levels(frame, 0);
  for (int n = 0; n < frame.size() && !world.slopes.empty(); ++n) {
    const Cell c = frame.at(n);
    const double height = floor_height(world, frame.center(c));
    int& level = levels.data[static_cast<std::size_t>(n)];
    while ((level + 1) * frame.resolution <= height + 1e-9 && world.solid(c.i, c.j, level)) ++level;
  }
  return levels;
}

std::shared_ptr<const VoxelGrid> over_the_floor(const World& world, double step) {
  const VoxelGrid& voxels = world.voxels;
  if (world.slopes.empty()) return {std::shared_ptr<void>(), &voxels};
  const GridFrame& frame = voxels.frame();
  const double r = frame.resolution;
  const Grid<int> levels = floor_levels(world);
  auto over = std::make_shared<VoxelGrid>(frame, voxels.k0(), voxels.depth(), voxels.data());
  const int top = voxels.k0() + voxels.depth();
  for (int n = 0; n < frame.size(); ++n) {
    const Cell c = frame.at(n);
    const Slope* slope = slope_at(world, frame.center(c));
    if (slope == nullptr) continue;
    const double height = floor_height(world, frame.center(c));
    bool closed = is_too_steep(*slope, step);
    for (int side = 0; side < 9 && !closed; ++side) {
      const Cell beside{c.i + side % 3 - 1, c.j + side / 3 - 1};
      const double other = floor_height(world, frame.center(beside));
      const bool is_wall =
          !frame.contains(beside) || (other == 0.0 && world.solid(beside.i, beside.j, 0));
      closed = !is_wall && !joins(height - other, r * std::hypot(side % 3 - 1, side / 3 - 1), step);
    }
    for (int k = voxels.k0(); k < top; ++k) {
      const int from = std::min(k + levels[c], top - 1);
      // No floor, as of a hole: sight passes, and a body does not.
      const bool no_floor = closed && k < 0;
      over->set(c.i, c.j, k, no_floor ? CellState::kFree : voxels.state(c.i, c.j, from));
    }
  }
  return over;
}

World flattened(const World& world, double step) {
  World flat = world;
  flat.voxels = *over_the_floor(world, step);
  flat.slopes.clear();
  return flat;
}

}  // namespace prospect
