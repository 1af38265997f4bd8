// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "models/camera.h"
#include "perception/mapping/depth_image.h"
#include "perception/odometry/motion_in_view.h"

namespace prospect {

/// Every `stride`-th pixel of a depth image along rows and columns, from stride / 2 on, as points.
struct PointLattice {
  int stride = 1, columns = 0, rows = 0;
  std::vector<Eigen::Vector3d> points;  ///< in C, row by row [m]
  /// Whether a pixel shows a surface that may be of a thing: it has a depth, and is not of the
  /// floor.
  std::vector<char> solid;
};

/// Which pixels of the lattice show something that moves; parallel to its points.
///
/// A landmark, given in C, marks the pixel nearest to it whose depth is its own within a tenth.
/// From all that are marked surfaces grow to neighbours, of eight, whose depth differs by at most
/// `edge` of it, or to which depths go by such steps from pixel to pixel. A pixel is of the
/// landmark to which the way along the surface is shortest, and moves if that landmark moves and is
/// at most 1 m away: from the chest to the feet. So a person who touches a wall takes of it what is
/// nearer to them than to what is known to rest. `lattice` is of `image`. Deterministic.
std::vector<char> moving_surface(const PinholeCamera& camera, const DepthImage& image,
                                 const PointLattice& lattice, const MotionInView& in_C,
                                 double edge);

/// The same landmarks, moved by T.
MotionInView operator*(const Eigen::Isometry3d& T, const MotionInView& motion);

}  // namespace prospect
