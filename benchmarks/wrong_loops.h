// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "perception/odometry/relative_pose.h"

namespace prospect {

/// A loop that somebody who recognises places took for right.
struct WrongLoop {
  int from = 0, to = 0;
  RelativePose measured;
};

/// Loops between keyframes more than 10 m apart, at least `count` of them, of a kind:
///   alike     two places look the same: the identity, and noise
///   anywhere  the relative pose of any two keyframes, more than 10 m or 0.5 rad from the true one
///   groups    5 to 10 in a row that agree with each other, from two stretches that look the same
///   beside    3 to 10 in a row that take a stretch for one 10.5 to 35 m beside it, in the same
///             direction: the next street, aisle or floor
/// Noise: 0.3 m an axis, 0.1 rad an axis (planar: 0.17 rad of yaw). Informations are drawn from
/// those given. Fewer where the poses do not have so many.
std::vector<WrongLoop> wrong_loops(const std::map<int, Eigen::Isometry3d>& truth, bool planar,
                                   const std::string& kind, int count, std::uint64_t seed,
                                   const std::vector<Eigen::Matrix<double, 6, 6>>& informations);

/// The kinds, as they are named above.
std::vector<std::string> wrong_loop_kinds();

}  // namespace prospect
