// SPDX-License-Identifier: Apache-2.0
#include "engine/task/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/types.h"

namespace prospect {
namespace {

constexpr std::size_t kMostCorners = 1000;
constexpr double kTouching = 1e-6;  // [m] within which sides that are not neighbours meet

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double squared_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                        const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * along).squaredNorm();
}

const Eigen::Vector2d& corner(const Polygon& polygon, std::size_t n) {
  return polygon[n % polygon.size()];
}

}  // namespace

double segment_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const double c_side = cross(b - a, c - a), d_side = cross(b - a, d - a);
  const double a_side = cross(d - c, a - c), b_side = cross(d - c, b - c);
  // Strictly on either side of each other: they cross. What only touches has distance 0 anyway.
  if (((c_side > 0.0 && d_side < 0.0) || (c_side < 0.0 && d_side > 0.0)) &&
      ((a_side > 0.0 && b_side < 0.0) || (a_side < 0.0 && b_side > 0.0))) {
    return 0.0;
  }
  return std::sqrt(std::min({squared_distance(a, c, d), squared_distance(b, c, d),
                             squared_distance(c, a, b), squared_distance(d, a, b)}));
}

std::string polygon_fault(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3 || n > kMostCorners) {
    return std::to_string(n) + " corners; expected 3 to " + std::to_string(kMostCorners);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (polygon[i].allFinite() && polygon[i].cwiseAbs().maxCoeff() < kFarthest) continue;
    return "corner " + std::to_string(i + 1) +
           " is not finite or beyond 1000 km; expected one within";
  }
  for (std::size_t i = 0; i < n; ++i) {
    if ((corner(polygon, i + 1) - polygon[i]).norm() > kTouching) continue;
    return "corners " + std::to_string(i + 1) + " and " + std::to_string((i + 1) % n + 1) +
           " are the same; expected each once";
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      bool meet = false;
      if (j == i + 1 || (i == 0 && j == n - 1)) {
        // Neighbours share a corner; they must not fold back onto each other.
        const std::size_t first = j == i + 1 ? i : j;
        const Eigen::Vector2d in =
            (corner(polygon, first + 1) - corner(polygon, first)).normalized();
        const Eigen::Vector2d out =
            (corner(polygon, first + 2) - corner(polygon, first + 1)).normalized();
        meet = in.dot(out) < 0.0 && std::abs(cross(in, out)) < 1e-9;
      } else {
        meet = segment_distance(polygon[i], corner(polygon, i + 1), polygon[j],
                                corner(polygon, j + 1)) <= kTouching;
      }
      if (!meet) continue;
      return "sides " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
             " meet; expected a polygon that does not cross itself";
    }
  }
  return "";
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

double signed_distance(const Polygon& polygon, const Eigen::Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    least = std::min(least, squared_distance(p, polygon[i], corner(polygon, i + 1)));
  }
  return contains(polygon, p) ? -std::sqrt(least) : std::sqrt(least);
}

// Sutherland and Hodgman.
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double offset) {
  Polygon kept;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Eigen::Vector2d& a = polygon[n];
    const Eigen::Vector2d& b = corner(polygon, n + 1);
    const double at_a = normal.dot(a) - offset, at_b = normal.dot(b) - offset;
    if (at_a >= 0.0) kept.push_back(a);
    if ((at_a >= 0.0) != (at_b >= 0.0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  if (kept.size() < 3 || area(kept) <= 0.0) kept.clear();
  return kept;
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    twice += cross(polygon[i], corner(polygon, i + 1));
  }
  return 0.5 * std::abs(twice);
}

}  // namespace prospect
