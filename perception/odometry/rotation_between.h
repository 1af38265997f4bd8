#pragma once

#include <Eigen/Geometry>

namespace prospect {

/// The rotation by the smallest angle that turns the direction of `from` into that of `to`; both
/// are of any length but zero. Of opposite directions, one of the half turns. (A function of its
/// own because Eigen's takes seconds to compile wherever it is used.)
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace prospect
