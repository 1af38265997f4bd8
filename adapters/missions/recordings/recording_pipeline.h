// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "perception/pipeline/perception_pipeline.h"

namespace prospect {

/// How the pipeline takes a recording: the body is its sensor, free in space, and there are no
/// wheels. A recording may rest for as long as it likes.
/// start: T_WB at the first frame.
PerceptionOptions recording_options(const Eigen::Isometry3d& start = Eigen::Isometry3d::Identity());

/// Enters a depth image or scan, which `take` hands to the pipeline, at the pose of its sensor:
/// what became of it. One that the pipeline leaves out before it comes to the map is rejected.
/// T_WB null: that of the frame before, which has the same stamp.
MappedFrame map_at(PerceptionPipeline& perception, double stamp, const Eigen::Isometry3d* T_WB,
                   const std::function<InputResult()>& take);

}  // namespace prospect
