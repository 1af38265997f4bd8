// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/heading_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace prospect {
namespace {

constexpr double kRounding = 1e-9;  // [m]; sizes given as decimals must not fail by an ulp
constexpr double kTurn = 2.0 * std::numbers::pi;

using Corners = std::vector<Eigen::Vector2d>;

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double s = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + s * along - p).norm();
}

/// The largest gap along an outward normal of `from`, negative where they overlap along all.
double gap_along_edges(const Corners& from, const Corners& to) {
  double gap = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; from.size() > 1 && i < from.size(); ++i) {
    const Eigen::Vector2d edge = from[(i + 1) % from.size()] - from[i];
    const double length = edge.norm();
    if (length == 0.0) continue;
    const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()) / length;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& p : to) nearest = std::min(nearest, normal.dot(p - from[i]));
    gap = std::max(gap, nearest);
  }
  return gap;
}

double least_distance(const Corners& a, const Corners& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : a) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      least = std::min(least, distance_to_segment(p, b[i], b[(i + 1) % b.size()]));
    }
  }
  return least;
}

/// Of convex polygons (a: a point, too), counter-clockwise: their distance, or minus the least path
/// that parts them, which is along a normal of one of them.
double signed_distance(const Corners& a, const Corners& b) {
  const double gap = std::max(gap_along_edges(a, b), gap_along_edges(b, a));
  if (gap <= 0.0) return gap;
  return std::min(least_distance(a, b), least_distance(b, a));
}

}  // namespace

double heading_at(int k) { return kTurn * k / kHeadings; }

int nearest_heading(double yaw) {
  const double turns = yaw / kTurn;
  const int k = static_cast<int>(std::lround((turns - std::floor(turns)) * kHeadings));
  return k % kHeadings;
}

double outline_distance(const std::vector<OutlinePart>& outline, const Eigen::Vector2d& position,
                        double yaw, const Eigen::Vector2d& low, double side) {
  const Corners square = {low, low + Eigen::Vector2d(side, 0.0), low + Eigen::Vector2d(side, side),
                          low + Eigen::Vector2d(0.0, side)};
  Eigen::Matrix2d turn;
  turn << std::cos(yaw), -std::sin(yaw), std::sin(yaw), std::cos(yaw);
  double least = std::numeric_limits<double>::infinity();
  Corners placed;
  for (const OutlinePart& part : outline) {
    placed.clear();
    for (const Eigen::Vector2d& p : part.corners) placed.emplace_back(position + turn * p);
    least = std::min(least, signed_distance(placed, square) - part.radius);
  }
  return least;
}

HeadingFit::HeadingFit(const RobotShape& shape, double room, double resolution) {
  if (!std::isfinite(room) || !(resolution > 0.0) || !std::isfinite(resolution)) {
    throw std::invalid_argument("heading fit: room " + std::to_string(room) + " m, resolution " +
                                std::to_string(resolution) +
                                " m; expected finite numbers, a resolution > 0");
  }
  const std::vector<OutlinePart> outline = ground_outline(shape);
  const double farthest = circumscribed_radius(shape) + std::max(0.0, room);
  const int reach = static_cast<int>(std::ceil(farthest / resolution + 0.5));
  const Eigen::Vector2d center = Eigen::Vector2d::Constant(0.5 * resolution);
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      HeadingMask bars = kNoHeading;
      const Eigen::Vector2d low(di * resolution, dj * resolution);
      for (int k = 0; k < kHeadings; ++k) {
        const double d = outline_distance(outline, center, heading_at(k), low, resolution);
        if (d < room - kRounding) bars |= HeadingMask{1} << k;
      }
      if (bars == kNoHeading) continue;
      entries_.push_back({di, dj, bars});
      reach_ = std::max({reach_, std::abs(di), std::abs(dj)});
    }
  }
}

}  // namespace prospect
