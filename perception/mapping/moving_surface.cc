// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/moving_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <queue>
#include <tuple>

namespace prospect {
namespace {

constexpr double kSameDepth = 0.1;  // share of the depth
constexpr double kMostWay = 1.0;    // [m]
constexpr int kResting = 1, kMoving = 2;

/// Whether depths go from one pixel to another, `steps` pixels along (du, dv), by small steps
/// alone.
bool goes_on(const DepthImage& image, int u, int v, int du, int dv, int steps, double edge) {
  double before = image.at(u, v);
  for (int n = 1; n <= steps; ++n) {
    const double z = image.at(u + n * du, v + n * dv);
    if (!(std::abs(z - before) <= edge * std::min(z, before))) return false;
    before = z;
  }
  return true;
}

}  // namespace

std::vector<char> moving_surface(const PinholeCamera& camera, const DepthImage& image,
                                 const PointLattice& lattice, const MotionInView& in_C,
                                 double edge) {
  std::vector<char> moves(lattice.points.size(), 0);
  // Ways along the surface, shortest first, the resting before the moving: whose, and to where.
  using Way = std::tuple<double, int, std::size_t>;
  std::priority_queue<Way, std::vector<Way>, std::greater<>> ways;
  const int middle = lattice.stride / 2;  // of a stride [px]
  const auto mark = [&](const std::vector<Eigen::Vector3d>& landmarks, int whose) {
    for (const Eigen::Vector3d& p : landmarks) {
      if (!(p.z() > 0.0)) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      const double column = (pixel.x() - middle) / lattice.stride;
      const double row = (pixel.y() - middle) / lattice.stride;
      if (!(column > -0.5 && row > -0.5 && column < lattice.columns - 0.5 &&
            row < lattice.rows - 0.5)) {
        continue;
      }
      const auto at =
          static_cast<std::size_t>(std::lround(row)) * static_cast<std::size_t>(lattice.columns) +
          static_cast<std::size_t>(std::lround(column));
      if (lattice.solid[at] && std::abs(lattice.points[at].z() - p.z()) <= kSameDepth * p.z()) {
        ways.emplace(0.0, whose, at);
      }
    }
  };
  mark(in_C.moving, kMoving);
  if (ways.empty()) return moves;
  mark(in_C.still, kResting);

  std::vector<char> owner(lattice.points.size(), 0);
  while (!ways.empty()) {
    const auto [way, whose, at] = ways.top();
    ways.pop();
    if (owner[at] != 0) continue;
    owner[at] = static_cast<char>(whose);
    moves[at] = whose == kMoving;
    const int column = static_cast<int>(at) % lattice.columns;
    const int row = static_cast<int>(at) / lattice.columns;
    const Eigen::Vector3d& here = lattice.points[at];
    for (int r = std::max(0, row - 1); r <= std::min(lattice.rows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(lattice.columns - 1, column + 1); ++c) {
        const auto next = static_cast<std::size_t>(r) * static_cast<std::size_t>(lattice.columns) +
                          static_cast<std::size_t>(c);
        if (owner[next] != 0 || !lattice.solid[next]) continue;
        const Eigen::Vector3d& there = lattice.points[next];
        const int s = lattice.stride;
        if (std::abs(there.z() - here.z()) > edge * std::min(here.z(), there.z()) &&
            !goes_on(image, s / 2 + s * column, s / 2 + s * row, c - column, r - row, s, edge)) {
          continue;
        }
        const double longer = way + (there - here).norm();
        if (longer <= kMostWay) ways.emplace(longer, whose, next);
      }
    }
  }
  return moves;
}

MotionInView operator*(const Eigen::Isometry3d& T, const MotionInView& motion) {
  MotionInView moved = motion;
  for (std::vector<Eigen::Vector3d>* points : {&moved.moving, &moved.still}) {
    for (Eigen::Vector3d& p : *points) p = T * p;
  }
  return moved;
}

}  // namespace prospect
