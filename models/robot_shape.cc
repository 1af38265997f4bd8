// SPDX-License-Identifier: Apache-2.0
#include "models/robot_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;  // convex, counter-clockwise

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Added to every radius, so that rounding never leaves a point of the body outside its bound [m].
constexpr double kMargin = 1e-9;
// A hull thinner than this is taken as flat [m].
constexpr double kFlat = 1e-6;
constexpr int kMaxDiscs = 8;
constexpr int kMaxSpheres = 64;
// Sides of the circumscribed polygon that stands for a circle where spheres bound a cylinder.
constexpr int kCircleSides = 32;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Andrew's monotone chain.
Polygon convex_hull(Polygon points) {
  const auto less = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= start + 2 &&
             cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// The part of a convex polygon where axis . p <= bound (Sutherland and Hodgman).
Polygon clip(const Polygon& polygon, const Eigen::Vector2d& axis, double bound) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double da = axis.dot(a) - bound, db = axis.dot(b) - bound;
    if (da <= 0.0) kept.push_back(a);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0))
      kept.push_back(a + da / (da - db) * (b - a));
  }
  return kept;
}

Disc circle_through(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {0.5 * (a + b), 0.5 * (b - a).norm()};
}

Disc circle_through(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d ab = b - a, ac = c - a;
  const double area = 2.0 * cross(ab, ac);
  const Eigen::Vector2d to_center =
      Eigen::Vector2d(ac.y() * ab.squaredNorm() - ab.y() * ac.squaredNorm(),
                      ab.x() * ac.squaredNorm() - ac.x() * ab.squaredNorm()) /
      area;
  return {a + to_center, to_center.norm()};
}

/// Smallest enclosing circle (Welzl's algorithm in its incremental form, in the order given: the
/// polygons here have few vertices). The radius is enlarged to the farthest vertex in the end, so
/// the result encloses even where rounding misjudged a case.
Disc smallest_enclosing_circle(const Polygon& points) {
  const auto outside = [](const Disc& d, const Eigen::Vector2d& p) {
    return !((p - d.center).norm() <= d.radius * (1.0 + 1e-12) + 1e-15);
  };
  Disc disc{points.front(), 0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!outside(disc, points[i])) continue;
    disc = {points[i], 0.0};
    for (std::size_t j = 0; j < i; ++j) {
      if (!outside(disc, points[j])) continue;
      disc = circle_through(points[i], points[j]);
      for (std::size_t k = 0; k < j; ++k) {
        if (!outside(disc, points[k])) continue;
        const Disc through = circle_through(points[i], points[j], points[k]);
        if (through.center.allFinite()) disc = through;
      }
    }
  }
  for (const Eigen::Vector2d& p : points) {
    disc.radius = std::max(disc.radius, (p - disc.center).norm());
  }
  disc.radius += kMargin;
  return disc;
}

/// How far a disc reaches beyond a convex outline, at most (its centre is inside): over the edges,
/// the radius less the centre's distance from the edge's line.
double overhang_of(const Disc& disc, const Polygon& outline) {
  double overhang = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const double length = edge.norm();
    if (length == 0.0) continue;
    overhang = std::max(overhang, disc.radius - cross(edge, disc.center - outline[i]) / length);
  }
  return overhang;
}

/// Rectangle around a polygon: long axis a, short axis b, and the polygon's extent along them.
struct Frame {
  Eigen::Vector2d a, b;
  double a_min, a_max, b_min, b_max;
};

/// The enclosing rectangle of least area; one of its sides lies on an edge of the polygon.
Frame bounding_rectangle(const Polygon& outline) {
  Frame best{};
  double best_area = kInfinity;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    if (edge.norm() == 0.0) continue;
    Frame f{edge.normalized(), {}, kInfinity, -kInfinity, kInfinity, -kInfinity};
    f.b = {-f.a.y(), f.a.x()};
    for (const Eigen::Vector2d& p : outline) {
      f.a_min = std::min(f.a_min, f.a.dot(p));
      f.a_max = std::max(f.a_max, f.a.dot(p));
      f.b_min = std::min(f.b_min, f.b.dot(p));
      f.b_max = std::max(f.b_max, f.b.dot(p));
    }
    const double area = (f.a_max - f.a_min) * (f.b_max - f.b_min);
    if (area < best_area * (1.0 - 1e-12)) {
      best_area = area;
      best = f;
    }
  }
  if (best.b_max - best.b_min > best.a_max - best.a_min) {
    best = {best.b, -best.a, best.b_min, best.b_max, -best.a_max, -best.a_min};
  }
  return best;
}

/// Smallest circles of the parts into which cuts across the long axis (between fractions of its
/// length) and `rows[i]` equal rows within the i-th slice divide the outline. Empty parts vanish.
std::vector<Disc> cover(const Polygon& outline, const Frame& f, const std::vector<double>& cuts,
                        const std::vector<int>& rows) {
  std::vector<Disc> discs;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double from = f.a_min + cuts[i] * (f.a_max - f.a_min);
    const double to = f.a_min + cuts[i + 1] * (f.a_max - f.a_min);
    Polygon slice = outline;
    if (i > 0) slice = clip(slice, -f.a, -from);
    if (i + 1 < rows.size()) slice = clip(slice, f.a, to);
    for (int j = 0; j < rows[i]; ++j) {
      const double low = f.b_min + (f.b_max - f.b_min) * j / rows[i];
      const double high = f.b_min + (f.b_max - f.b_min) * (j + 1) / rows[i];
      Polygon part = slice;
      if (j > 0) part = clip(part, -f.b, -low);
      if (j + 1 < rows[i]) part = clip(part, f.b, high);
      if (!part.empty()) discs.push_back(smallest_enclosing_circle(part));
    }
  }
  return discs;
}

double overhang_of(const std::vector<Disc>& discs, const Polygon& outline) {
  double overhang = 0.0;
  for (const Disc& disc : discs) overhang = std::max(overhang, overhang_of(disc, outline));
  return overhang;
}

/// Fewest discs that keep to `overhang`; if at most eight cannot, those with the least overhang.
/// Searched arrangements (our choice): grids, and a row of discs across the full width between two
/// end columns of smaller ones, which fit the corners better than a plain row can.
std::vector<Disc> discs_over(const Polygon& outline, double overhang) {
  const Frame frame = bounding_rectangle(outline);
  std::vector<Disc> best;
  double best_overhang = kInfinity;
  const auto consider = [&](const std::vector<double>& cuts, const std::vector<int>& rows) {
    std::vector<Disc> discs = cover(outline, frame, cuts, rows);
    const double found = overhang_of(discs, outline);
    const bool keeps = found <= overhang, best_keeps = best_overhang <= overhang;
    const bool better = keeps != best_keeps                    ? keeps
                        : keeps && discs.size() != best.size() ? discs.size() < best.size()
                                                               : found < best_overhang - 1e-12;
    if (better) {
      best = std::move(discs);
      best_overhang = found;
    }
  };
  for (int columns = 1; columns <= kMaxDiscs; ++columns) {
    std::vector<double> cuts(columns + 1);
    for (int i = 0; i <= columns; ++i) cuts[i] = static_cast<double>(i) / columns;
    for (int rows = 1; rows * columns <= kMaxDiscs; ++rows) {
      consider(cuts, std::vector<int>(columns, rows));
    }
  }
  constexpr int kEndWidths = 40;
  for (int end_rows = 2; 2 * end_rows < kMaxDiscs; ++end_rows) {
    for (int middle = 1; 2 * end_rows + middle <= kMaxDiscs; ++middle) {
      std::vector<int> rows(middle + 2, 1);
      rows.front() = rows.back() = end_rows;
      for (int w = 1; w < kEndWidths; ++w) {
        const double end = 0.5 * w / kEndWidths;
        std::vector<double> cuts(middle + 3);
        cuts.front() = 0.0;
        cuts.back() = 1.0;
        for (int i = 0; i <= middle; ++i) cuts[i + 1] = end + (1.0 - 2.0 * end) * i / middle;
        consider(cuts, rows);
      }
    }
  }
  return best;
}

std::vector<Eigen::Vector3d> corners(const BoxShape& box) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(box.center + 0.5 * box.size.cwiseProduct(Eigen::Vector3d(
                                             i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return corners;
}

Polygon projection(const std::vector<Eigen::Vector3d>& vertices) {
  Polygon points;
  for (const Eigen::Vector3d& v : vertices) points.push_back(v.head<2>());
  return convex_hull(std::move(points));
}

/// Ground outline of the part of a hull between two heights: the vertices between them and the
/// points where segments between vertices cross either height. Segments inside the hull do no harm.
Polygon slab_outline(const std::vector<Eigen::Vector3d>& vertices, double z_min, double z_max) {
  Polygon points;
  for (const Eigen::Vector3d& v : vertices) {
    if (v.z() >= z_min && v.z() <= z_max) points.push_back(v.head<2>());
  }
  for (double z : {z_min, z_max}) {
    for (const Eigen::Vector3d& a : vertices) {
      for (const Eigen::Vector3d& b : vertices) {
        if (a.z() < z && b.z() > z) {
          points.push_back((a + (z - a.z()) / (b.z() - a.z()) * (b - a)).head<2>());
        }
      }
    }
  }
  return convex_hull(std::move(points));
}

/// Spheres over a body given by the outlines of its horizontal slabs: a grid of smallest circles in
/// each slab, each widened to a sphere that reaches the slab's top and bottom.
template <class Outline>
std::vector<Sphere> spheres_over(const Outline& outline, const VerticalExtent& extent,
                                 double overhang) {
  std::vector<Sphere> best;
  double best_overhang = kInfinity;
  for (int slabs = 1; slabs <= 8; ++slabs) {
    const double height = (extent.z_max - extent.z_min) / slabs;
    std::vector<Polygon> outlines;
    std::vector<Frame> frames;
    for (int k = 0; k < slabs; ++k) {
      outlines.push_back(outline(k == 0 ? extent.z_min : extent.z_min + k * height,
                                 k + 1 == slabs ? extent.z_max : extent.z_min + (k + 1) * height));
      frames.push_back(bounding_rectangle(outlines.back()));
    }
    for (int columns = 1; columns * slabs <= kMaxSpheres; ++columns) {
      std::vector<double> cuts(columns + 1);
      for (int i = 0; i <= columns; ++i) cuts[i] = static_cast<double>(i) / columns;
      for (int rows = 1; rows <= columns && rows * columns * slabs <= kMaxSpheres; ++rows) {
        std::vector<Sphere> spheres;
        double found = 0.0;
        for (int k = 0; k < slabs; ++k) {
          const double z = extent.z_min + (k + 0.5) * height;
          for (const Disc& disc :
               cover(outlines[k], frames[k], cuts, std::vector<int>(columns, rows))) {
            const double radius = std::hypot(disc.radius, 0.5 * height);
            found = std::max(found, overhang_of({disc.center, radius}, outlines[k]));
            found = std::max(found, radius - (z - extent.z_min));
            found = std::max(found, radius - (extent.z_max - z));
            spheres.push_back({{disc.center.x(), disc.center.y(), z}, radius});
          }
        }
        const bool keeps = found <= overhang, best_keeps = best_overhang <= overhang;
        const bool better = keeps != best_keeps ? keeps
                            : keeps && spheres.size() != best.size()
                                ? spheres.size() < best.size()
                                : found < best_overhang - 1e-12;
        if (better) {
          best = std::move(spheres);
          best_overhang = found;
        }
      }
    }
  }
  return best;
}

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

void check_overhang(double overhang) { check_positive("robot shape", "overhang", overhang); }

void check_finite_vector(std::string_view owner, std::string_view name, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) check_finite(owner, name, v[i]);
}

/// Thickness of a point set: its extent in the last of three orthogonal directions, each chosen by
/// the farthest point from what the earlier ones span. Zero for coplanar points.
double thickness(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> basis;
  double farthest = 0.0;
  for (int dimension = 0; dimension < 3; ++dimension) {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) {
      Eigen::Vector3d rest = p - points.front();
      for (const Eigen::Vector3d& e : basis) rest -= e.dot(rest) * e;
      if (rest.norm() > direction.norm()) direction = rest;
    }
    farthest = direction.norm();
    if (farthest < kFlat) return farthest;
    basis.push_back(direction / farthest);
  }
  return farthest;
}

}  // namespace

void describe(Knobs& knobs, Sphere& s) {
  knobs.number("radius", s.radius, {0.01, 20.0}, "m", "radius");
  knobs.numbers("center", s.center.data(), 3, {-5.0, 5.0}, "m", "centre, in the body frame");
}

void describe(Knobs& knobs, BoxShape& s) {
  knobs.numbers("size", s.size.data(), 3, {0.01, 20.0}, "m", "edge lengths");
  knobs.numbers("center", s.center.data(), 3, {-5.0, 5.0}, "m", "centre, in the body frame");
}

void describe(Knobs& knobs, CylinderShape& s) {
  knobs.number("radius", s.radius, {0.01, 20.0}, "m", "radius about the axis");
  knobs.number("height", s.height, {0.01, 20.0}, "m", "height");
  knobs.numbers("center", s.center.data(), 3, {-5.0, 5.0}, "m", "centre, in the body frame");
}

void validate(const RobotShape& shape) {
  std::visit(Overload{[](const SphereSetShape& s) {
                        if (s.spheres.empty()) {
                          throw std::invalid_argument(
                              "robot shape: the sphere set is empty; expected at least one sphere");
                        }
                        for (const Sphere& sphere : s.spheres) {
                          check_knobs("robot sphere", sphere);
                        }
                      },
                      [](const BoxShape& s) { check_knobs("robot box", s); },
                      [](const CylinderShape& s) { check_knobs("robot cylinder", s); },
                      [](const ConvexShape& s) {
                        constexpr std::string_view kOwner = "robot hull";
                        check_parameter(s.vertices.size() >= 4, kOwner, "number of vertices",
                                        static_cast<double>(s.vertices.size()), "at least 4");
                        for (const Eigen::Vector3d& v : s.vertices) {
                          check_finite_vector(kOwner, "vertex", v);
                        }
                        const double thick = thickness(s.vertices);
                        check_parameter(thick >= kFlat, kOwner, "thickness", thick,
                                        "at least 1e-6 m (vertices not in one plane)");
                      }},
             shape);
}

VerticalExtent vertical_extent(const RobotShape& shape) {
  validate(shape);
  VerticalExtent extent{kInfinity, -kInfinity};
  const auto include = [&](double low, double high) {
    extent.z_min = std::min(extent.z_min, low);
    extent.z_max = std::max(extent.z_max, high);
  };
  std::visit(Overload{[&](const SphereSetShape& s) {
                        for (const Sphere& sphere : s.spheres) {
                          include(sphere.center.z() - sphere.radius,
                                  sphere.center.z() + sphere.radius);
                        }
                      },
                      [&](const BoxShape& s) {
                        include(s.center.z() - 0.5 * s.size.z(), s.center.z() + 0.5 * s.size.z());
                      },
                      [&](const CylinderShape& s) {
                        include(s.center.z() - 0.5 * s.height, s.center.z() + 0.5 * s.height);
                      },
                      [&](const ConvexShape& s) {
                        for (const Eigen::Vector3d& v : s.vertices) include(v.z(), v.z());
                      }},
             shape);
  return extent;
}

VerticalExtent body_slice(const RobotShape& shape, double base_height) {
  const VerticalExtent extent = vertical_extent(shape);
  return {extent.z_min + base_height, extent.z_max + base_height};
}

std::vector<Disc> bounding_discs(const RobotShape& shape, double overhang) {
  validate(shape);
  check_overhang(overhang);
  return std::visit(
      Overload{[](const SphereSetShape& s) {
                 // A disc inside another one adds nothing; of equal ones the first stays.
                 std::vector<Disc> discs;
                 for (std::size_t i = 0; i < s.spheres.size(); ++i) {
                   const Disc disc{s.spheres[i].center.head<2>(), s.spheres[i].radius};
                   bool contained = false;
                   for (std::size_t j = 0; j < s.spheres.size() && !contained; ++j) {
                     const Disc other{s.spheres[j].center.head<2>(), s.spheres[j].radius};
                     const bool larger =
                         other.radius > disc.radius || (other.radius == disc.radius && j < i);
                     contained = larger &&
                                 (other.center - disc.center).norm() + disc.radius <= other.radius;
                   }
                   if (!contained) discs.push_back(disc);
                 }
                 return discs;
               },
               [&](const BoxShape& s) { return discs_over(projection(corners(s)), overhang); },
               [](const CylinderShape& s) {
                 return std::vector<Disc>{{s.center.head<2>(), s.radius}};
               },
               [&](const ConvexShape& s) { return discs_over(projection(s.vertices), overhang); }},
      shape);
}

std::vector<Sphere> bounding_spheres(const RobotShape& shape, double overhang) {
  validate(shape);
  check_overhang(overhang);
  const VerticalExtent extent = vertical_extent(shape);
  return std::visit(
      Overload{[](const SphereSetShape& s) { return s.spheres; },
               [&](const BoxShape& s) {
                 const Polygon outline = projection(corners(s));
                 return spheres_over([&](double, double) { return outline; }, extent, overhang);
               },
               [&](const CylinderShape& s) {
                 Polygon outline;
                 for (int i = 0; i < kCircleSides; ++i) {
                   const double angle = 2.0 * std::numbers::pi * i / kCircleSides;
                   outline.push_back(s.center.head<2>() +
                                     s.radius / std::cos(std::numbers::pi / kCircleSides) *
                                         Eigen::Vector2d(std::cos(angle), std::sin(angle)));
                 }
                 return spheres_over([&](double, double) { return outline; }, extent, overhang);
               },
               [&](const ConvexShape& s) {
                 return spheres_over(
                     [&](double z_min, double z_max) {
                       return slab_outline(s.vertices, z_min, z_max);
                     },
                     extent, overhang);
               }},
      shape);
}

double circumscribed_radius(const RobotShape& shape) {
  validate(shape);
  double radius = 0.0;
  std::visit(
      Overload{[&](const SphereSetShape& s) {
                 for (const Sphere& sphere : s.spheres) {
                   radius = std::max(radius, sphere.center.head<2>().norm() + sphere.radius);
                 }
               },
               [&](const BoxShape& s) {
                 for (const Eigen::Vector3d& v : corners(s)) {
                   radius = std::max(radius, v.head<2>().norm());
                 }
               },
               [&](const CylinderShape& s) { radius = s.center.head<2>().norm() + s.radius; },
               [&](const ConvexShape& s) {
                 for (const Eigen::Vector3d& v : s.vertices) {
                   radius = std::max(radius, v.head<2>().norm());
                 }
               }},
      shape);
  return radius;
}

std::vector<OutlinePart> ground_outline(const RobotShape& shape) {
  validate(shape);
  std::vector<OutlinePart> parts;
  std::visit(Overload{[&](const SphereSetShape& s) {
                        for (const Sphere& sphere : s.spheres) {
                          parts.push_back({{sphere.center.head<2>()}, sphere.radius});
                        }
                      },
                      [&](const BoxShape& s) {
                        parts.push_back({projection(corners(s)), 0.0});
                      },
                      [&](const CylinderShape& s) {
                        parts.push_back({{s.center.head<2>()}, s.radius});
                      },
                      [&](const ConvexShape& s) {
                        parts.push_back({projection(s.vertices), 0.0});
                      }},
             shape);
  return parts;
}

double inscribed_radius(const RobotShape& shape) {
  double radius = 0.0;
  for (const OutlinePart& part : ground_outline(shape)) {
    const Polygon& polygon = part.corners;
    double within = kInfinity;  // from the axis to the nearest edge, negative outside
    if (polygon.size() == 1) within = part.radius - polygon.front().norm();
    for (std::size_t i = 0; polygon.size() > 1 && i < polygon.size(); ++i) {
      const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
      within = std::min(within, cross(edge, -polygon[i]) / edge.norm());
    }
    radius = std::max(radius, within);
  }
  return radius;
}

bool is_round(const RobotShape& shape) {
  constexpr double kSame = 0.005;  // [m]
  return circumscribed_radius(shape) - inscribed_radius(shape) < kSame;
}

}  // namespace prospect
