// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>

#include "adapters/missions/recordings/map_run.h"
#include "models/types.h"
#include "perception/pipeline/perception_pipeline.h"

namespace prospect {

/// How the pipeline takes a recording: the body is its sensor, free in space, and there are no
/// wheels. A recording may rest for as long as it likes.
/// start: T_WB at the first frame.
/// loops: its poses drift, and places that are seen again correct them (straight_map.h).
PerceptionOptions recording_options(const Eigen::Isometry3d& start = Eigen::Isometry3d::Identity(),
                                    bool loops = false);

/// How far the poses of a recording may have drifted since its first one, if they err as those of
/// wheels do (WheelNoise, without the error of its scales): with the way d and the turn w between
/// two,
///     P <- carried(P) + R diag(along^2 d, across^2 d, turn^2 |w| + heading^2 d) R^T.
/// Recordings do not tell. Too large does no harm: the graph finds by what factor (LoopJudge).
class PoseDrift {
 public:
  /// Covariance of (x, y, z, yaw) at the next pose.
  Eigen::Matrix4d at(const Eigen::Isometry3d& T_WB);

 private:
  std::optional<Pose> before_;
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();
};

/// Enters a depth image or scan, which `take` hands to the pipeline, at the pose of its sensor:
/// what became of it. One that the pipeline leaves out before it comes to the map is rejected.
/// T_WB null: that of the frame before, which has the same stamp.
MapRunFrame map_at(PerceptionPipeline& perception, double stamp, const Eigen::Isometry3d* T_WB,
                   PoseDrift& drift, const std::function<InputResult()>& take);

/// The recording has ended: brings the map and the poses of `run` to where loops have moved them,
/// in the frame of the first one. Nothing, where the poses are taken as they are.
void straighten(PerceptionPipeline& perception, MapRun& run);

}  // namespace prospect
