// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace prospect {

/// Corners in W [m], in either sense; the last is joined to the first. Usable if polygon_fault() is
/// empty: simple (no side meets another), with an inside.
using Polygon = std::vector<Eigen::Vector2d>;

/// "" if the polygon is usable, else what is wrong: "2 corners; expected 3 to 1000", "corner 2 is
/// not finite or beyond 1000 km; expected one within", "sides 1 and 3 meet; expected a polygon that
/// does not cross itself" (counted from 1, side n begins at corner n).
std::string polygon_fault(const Polygon& polygon);

/// Distance of two segments a-b and c-d [m]; 0 if they meet.
double segment_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        const Eigen::Vector2d& c, const Eigen::Vector2d& d);

/// Whether p is inside (even number of sides crossed: not); of a usable polygon.
bool contains(const Polygon& polygon, const Eigen::Vector2d& p);

/// Signed distance from p to the polygon's boundary [m]: negative inside. Exact, 1-Lipschitz.
double signed_distance(const Polygon& polygon, const Eigen::Vector2d& p);

/// The part of a usable polygon where normal . p >= offset: empty, or corners of which some sides
/// may lie on each other along that line; contains() and signed_distance() take it.
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double offset);

/// Enclosed area [m^2], >= 0.
double area(const Polygon& polygon);

}  // namespace prospect
