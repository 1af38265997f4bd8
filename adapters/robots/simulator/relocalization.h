// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "adapters/robots/simulator/feature_camera.h"
#include "engine/maps/landmark_map.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

/// A pose found in the map, and the covariance of (x, y, yaw) in the map, [m] and [rad].
struct FoundPose {
  Pose pose;
  Eigen::Matrix3d covariance;
};

/// The pose of a planar base from one stereo image of landmarks whose places in the map are known:
/// what an odometry does that has lost its track and sees mapped points again.
///
///   xi = (x, y, yaw) = argmin (xi - xi_0)^T Omega (xi - xi_0) + sum_i rho(m_i^2),
///   m_i^2 = r_i^T S_i^{-1} r_i,   r_i = R(yaw) p_i + (x, y) - l_i,   p_i = T_BC Y(u, v, d)_i,
///   S_i   = R Sigma_Y,i R^T + Sigma_i + (2 cm)^2 I,   all horizontal,
///
/// with covariance H^{-1}, H = Omega + sum_i w_i J_i^T S_i^{-1} J_i with Huber's weights w_i at xi,
/// by Gauss-Newton from xi_0 = `guess` (which also gives z), rho being Huber's with threshold 1.5.
/// Omega, the inverse covariance of the guess (x, y in W [m], yaw [rad]), keeps few or
/// clustered points from moving the pose farther than it can have drifted; zero: nothing is known
/// of the guess, but Gauss-Newton starts there. A point counts only where it could be recognised:
/// seen within 0.5 rad and a factor of 1.5 in range of the view that created it, as judged at
/// `guess`.
///
/// Nothing if fewer than `least` points match or have m_i <= 3 in the end, or if the result is
/// farther from the guess than Omega allows (chi-squared with 3 degrees of freedom, 99.9 %).
/// find(feature): the mapped landmark, or null. Deterministic. Thread-safety: no state.
/// Source: our choice; the notes on vision ask for recovery against the last good keyframes and for
/// no silent jump.
std::optional<FoundPose> relocalize(const std::vector<FeatureObservation>& observations,
                                    const std::function<const Landmark*(std::uint32_t)>& find,
                                    const StereoCamera& stereo, const CameraMount& mount,
                                    const Pose& guess, const Eigen::Matrix3d& Omega,
                                    int least = 12);

}  // namespace prospect
