#pragma once

#include <vector>

#include "models/camera.h"
#include "perception/odometry/pose_drift.h"
#include "perception/odometry/pose_estimation.h"
#include "perception/odometry/track.h"

namespace prospect {

/// What a pose that was estimated from these observations of the tracks owes to the errors that
/// pose_drift.h keeps, linearised at it. `noise_variance`: of all noise over what is assumed
/// (residual_noise.h); both what the anchors measured and what is new in this frame are scaled by
/// it. The latter's share of the pose is H^-1 (H - sum J^T W D M D^T W J) H^-1, M of what the
/// anchors measured.
PoseDrift::Measurement drift_measurement(const StereoCamera& camera,
                                         const std::vector<Track>& tracks,
                                         const TrackObservations& observations,
                                         const PoseEstimate& pose,
                                         const PoseEstimatorOptions& options,
                                         double noise_variance);

}  // namespace prospect
