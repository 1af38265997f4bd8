// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "engine/maps/belief.h"

namespace prospect {

/// Whether a matrix can be the covariance of a pose's error in (x, y, z, yaw) [m, m, m, rad]:
/// finite, no entry beyond kFarthest^2, symmetric and positive semi-definite, both up to 1e-9 of
/// its largest entry (rounding). One that cannot be tells nothing of the error: it must never pass
/// for zero.
bool is_pose_covariance(const Eigen::Matrix4d& covariance);

/// Standard deviation [m] of the position (x, y, z) in its worst direction: the root of the largest
/// eigenvalue of the block. Expects is_pose_covariance().
double position_sigma(const Eigen::Matrix4d& covariance);

/// Why nothing bounds the error of a belief's pose; empty if something does.
///   - the covariance is none (is_pose_covariance()), or
///   - localization is lost, and the covariance is zero in x and y (nobody who is lost is exact) or
///     position_sigma() exceeds max_lost_error [m].
/// Of such a belief the map tells where things are only as far as they are in view now
/// (present_view.h).
///
/// Pure functions. Source: our choice.
std::string unbounded_pose_error(const Belief& belief, double max_lost_error);

}  // namespace prospect
