// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace prospect {

/// The rotation by the smallest angle that turns the direction of `from` into that of `to`; both
/// are of any length but zero. Of opposite directions, one of the half turns. As Eigen's
/// FromTwoVectors(), whose singular values take seconds to compile.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace prospect
