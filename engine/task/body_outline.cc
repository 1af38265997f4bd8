// SPDX-License-Identifier: Apache-2.0
#include "engine/task/body_outline.h"

#include <algorithm>
#include <variant>

namespace prospect {
namespace {

/// Andrew's monotone chain.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= start + 2) {
        const Eigen::Vector2d last = hull.back() - hull[hull.size() - 2], next = p - hull.back();
        if (last.x() * next.y() - last.y() * next.x() > 0.0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace

BodyOutline body_outline(const RobotShape& shape) {
  validate(shape);
  BodyOutline outline;
  if (const auto* spheres = std::get_if<SphereSetShape>(&shape)) {
    for (const Sphere& s : spheres->spheres) {
      outline.discs.push_back({s.center.head<2>(), s.radius});
    }
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    outline.discs.push_back({cylinder->center.head<2>(), cylinder->radius});
  } else if (const auto* box = std::get_if<BoxShape>(&shape)) {
    const Eigen::Vector2d half = 0.5 * box->size.head<2>(), c = box->center.head<2>();
    for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
      outline.corners.emplace_back(c.x() + x * half.x(), c.y() + y * half.y());
    }
  } else {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& v : std::get<ConvexShape>(shape).vertices) {
      points.emplace_back(v.head<2>());
    }
    outline.corners = convex_hull(std::move(points));
  }
  return outline;
}

}  // namespace prospect
