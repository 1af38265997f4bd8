// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "models/types.h"

namespace prospect {

/// The pose of a body whose z axis is that of W; what T_WB tilts besides is left out.
Pose body_pose(const Eigen::Isometry3d& T_WB);

/// Covariance of (x, y, z, yaw) of a body in W, from that of its camera's pose.
///   T_WB = T_WC T_BC^-1;  with T_CW <- exp(xi) T_CW,  T_WB <- T_WB exp(-Ad(T_BC) xi), so
///   d(p, yaw) = -(R_WB eta_t, (R_WB eta_omega)_z),  eta = Ad(T_BC) xi,
/// to first order, for a body whose z axis is that of W.
/// covariance: 6x6 of xi = (t, omega) in C [m, rad], as OdometryFrame gives it.
Eigen::Matrix4d body_covariance(const Eigen::Isometry3d& T_WC, const Eigen::Isometry3d& T_BC,
                                const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace prospect
