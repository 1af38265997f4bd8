// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

namespace prospect {

class Knobs;

/// Geometry of the robot's body in frame B [m]. The same value is turned into an exact FCL shape
/// for the certificate and into bounding spheres/discs for the clearance term.
struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.2;
};
struct SphereSetShape {
  std::vector<Sphere> spheres;
};
struct BoxShape {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = {0.4, 0.3, 0.3};
};
/// Axis along B's z.
struct CylinderShape {
  Eigen::Vector3d center = {0.0, 0.0, 0.3};
  double radius = 0.18;
  double height = 0.4;
};
/// Vertices of a convex hull, in B; at least four, not coplanar.
struct ConvexShape {
  std::vector<Eigen::Vector3d> vertices;
};

/// The knobs (models/knobs.h): all of them.
void describe(Knobs& knobs, Sphere& sphere);
void describe(Knobs& knobs, BoxShape& shape);
void describe(Knobs& knobs, CylinderShape& shape);

using RobotShape = std::variant<SphereSetShape, BoxShape, CylinderShape, ConvexShape>;

/// One vertical disc column of a planar bound of the shape: every point of the body lies in some
/// column {|(x,y) - center| <= radius, z_min <= z <= z_max} (B frame).
struct Disc {
  Eigen::Vector2d center;
  double radius;
};

/// Extent of the body along B's z [m].
struct VerticalExtent {
  double z_min;
  double z_max;
};

/// Throws std::invalid_argument (what was wrong, what was expected) for non-finite or non-positive
/// sizes, an empty sphere set, or a degenerate hull (fewer than four vertices, or thinner than 1e-6
/// m). The functions below throw the same.
void validate(const RobotShape& shape);
VerticalExtent vertical_extent(const RobotShape& shape);
/// The heights in W of an upright body whose B has its origin at z = base_height [m].
VerticalExtent body_slice(const RobotShape& shape, double base_height);
/// Discs whose union contains the body's ground projection, in B.
///   sphere set: one disc a sphere, without those inside others; cylinder: one disc, exact;
///   box, hull: the fewest of at most eight discs that overhang the ground outline by at most
///   `overhang` [m, > 0]; where eight cannot, those that overhang least. Each is the smallest
///   circle of one part of the outline, cut in a grid or in a row between two end columns (our
///   choice).
/// Deterministic; some ms, so call it once, not in a loop. Throws like validate().
std::vector<Disc> bounding_discs(const RobotShape& shape, double overhang = 0.03);
/// Spheres whose union contains the body, in B (for bases that move in 3-D): a sphere set itself;
/// for the others the fewest of at most 64 in a grid that overhang the outline of each horizontal
/// slab, the top and the bottom by at most `overhang` [m, > 0], else those that overhang least.
std::vector<Sphere> bounding_spheres(const RobotShape& shape, double overhang = 0.05);
/// Radius of the smallest vertical cylinder about B's z axis that contains the body [m].
double circumscribed_radius(const RobotShape& shape);

/// A convex part of a ground outline, in B: the points within `radius` [m] of the convex polygon
/// `corners` (counter-clockwise; one corner: a disc). Radius 0 for polygons.
struct OutlinePart {
  std::vector<Eigen::Vector2d> corners;
  double radius = 0.0;
};
/// The body's ground projection as the union of parts: a disc a sphere or cylinder, else one
/// polygon.
std::vector<OutlinePart> ground_outline(const RobotShape& shape);
/// Radius [m] of the largest disc about B's z axis within one part of the ground outline; 0 if none
/// holds the axis. With one part it is exact, with several a lower bound.
double inscribed_radius(const RobotShape& shape);
/// Whether heading makes less than 5 mm of difference to where the body fits: circumscribed and
/// inscribed radius are nearer than that.
bool is_round(const RobotShape& shape);

}  // namespace prospect
