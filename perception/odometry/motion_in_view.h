// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace prospect {

/// Landmarks in view of what moves against the world, and of the world itself: points of one frame,
/// which its user names [m]. Where nothing moves both are empty.
struct MotionInView {
  std::vector<Eigen::Vector3d> moving, still;
};

}  // namespace prospect
