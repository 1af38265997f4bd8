// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/shape_geometry.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <variant>

namespace prospect {
namespace {

PlacedGeometry placed(std::shared_ptr<fcl::CollisionGeometry<double>> geometry,
                      const Eigen::Vector3d& center) {
  geometry->computeLocalAABB();
  PlacedGeometry result{std::move(geometry), Eigen::Isometry3d::Identity()};
  result.T_BG.translation() = center;
  return result;
}

struct Builder {
  double inflation;

  std::vector<PlacedGeometry> operator()(const SphereSetShape& shape) const {
    std::vector<PlacedGeometry> parts;
    for (const Sphere& s : shape.spheres) {
      parts.push_back(placed(std::make_shared<fcl::Sphered>(s.radius + inflation), s.center));
    }
    return parts;
  }
  std::vector<PlacedGeometry> operator()(const BoxShape& shape) const {
    const Eigen::Vector3d size = shape.size.array() + 2.0 * inflation;
    return {placed(std::make_shared<fcl::Boxd>(size.x(), size.y(), size.z()), shape.center)};
  }
  std::vector<PlacedGeometry> operator()(const CylinderShape& shape) const {
    return {placed(
        std::make_shared<fcl::Cylinderd>(shape.radius + inflation, shape.height + 2.0 * inflation),
        shape.center)};
  }
  std::vector<PlacedGeometry> operator()(const ConvexShape& shape) const {
    auto vertices = std::make_shared<std::vector<fcl::Vector3d>>();
    if (inflation == 0.0) {
      *vertices = shape.vertices;
    } else {
      for (const Eigen::Vector3d& v : shape.vertices) {
        for (int corner = 0; corner < 8; ++corner) {
          vertices->push_back(v + inflation * Eigen::Vector3d((corner & 1) != 0 ? 1.0 : -1.0,
                                                              (corner & 2) != 0 ? 1.0 : -1.0,
                                                              (corner & 4) != 0 ? 1.0 : -1.0));
        }
      }
    }
    // Collision needs only the support function, which FCL takes from the vertices by a full scan
    // where there are no faces; points inside the hull do no harm.
    auto faces = std::make_shared<const std::vector<int>>();
    return {placed(std::make_shared<fcl::Convexd>(std::move(vertices), 0, std::move(faces)),
                   Eigen::Vector3d::Zero())};
  }
};

}  // namespace

std::vector<PlacedGeometry> shape_geometry(const RobotShape& shape, double inflation) {
  validate(shape);
  if (!(inflation >= 0.0) || !std::isfinite(inflation)) {
    throw std::invalid_argument("shape geometry: inflation is " + std::to_string(inflation) +
                                " m; expected a finite number >= 0");
  }
  return std::visit(Builder{inflation}, shape);
}

}  // namespace prospect
