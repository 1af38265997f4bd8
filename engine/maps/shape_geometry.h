// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "models/robot_shape.h"

namespace fcl {
template <typename S>
class CollisionGeometry;
}

namespace prospect {

/// One FCL geometry and where it sits in the body frame B.
struct PlacedGeometry {
  std::shared_ptr<fcl::CollisionGeometry<double>> geometry;
  Eigen::Isometry3d T_BG = Eigen::Isometry3d::Identity();  ///< maps geometry coordinates to B
};

/// The robot's body as FCL geometries whose union is the shape, grown by `inflation` [m] >= 0: the
/// result contains every point within `inflation` of the body. A sphere set gives one fcl::Sphere a
/// sphere; a box, a fcl::Box; a cylinder, a fcl::Cylinder; a convex hull, a fcl::Convex.
///
/// Spheres grow exactly (to r + inflation); boxes and cylinders grow by `inflation` on every face
/// (sharp edges, hence up to inflation (sqrt 3 - 1) more at corners); a hull becomes the hull of
/// its vertices shifted by (+-inflation, +-inflation, +-inflation).
///
/// Throws std::invalid_argument as validate(shape) does, and for a negative or non-finite
/// inflation. Source: formulation, section 5; how shapes grow is our choice.
std::vector<PlacedGeometry> shape_geometry(const RobotShape& shape, double inflation = 0.0);

}  // namespace prospect
