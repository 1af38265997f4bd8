#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "adapters/simulator/feature_camera.h"
#include "engine/landmark_map.h"
#include "models/camera.h"
#include "models/types.h"

namespace prospect {

/// The pose of a planar base from one stereo image of landmarks whose places in the map are known:
/// what an odometry does that has lost its track and sees mapped points again.
///
///   (x, y, yaw) = argmin sum_i w_i rho(|R(yaw) p_i + (x, y) - l_i|^2),   p_i = T_BC Y(u, v, d)_i
///
/// over the ground plane, w_i = 1 / (tr Sigma_Y,i + tr Sigma_i), solved in closed form (weighted
/// Procrustes) with Huber reweighting. A point counts only where it could be recognised: seen
/// within 0.5 rad and a factor of 1.5 in range of the view that created it, as judged at `guess`,
/// which also gives z.
///
/// Nothing if fewer than `least` points match or agree within 3 standard deviations + 2 cm.
/// find(feature): the mapped landmark, or null. Deterministic. Thread-safety: no state.
/// Source: our choice; the notes on vision ask for recovery against the last good keyframes.
std::optional<Pose> relocalize(const std::vector<FeatureObservation>& observations,
                               const std::function<const Landmark*(std::uint32_t)>& find,
                               const StereoCamera& stereo, const CameraMount& mount,
                               const Pose& guess, int least = 12);

}  // namespace prospect
