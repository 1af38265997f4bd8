// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <variant>

#include "models/image.h"
#include "models/imu_sample.h"
#include "models/types.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pipeline/perception_pipeline.h"

namespace prospect {

struct Belief;

/// A stereo pair; the images are shared, not copied.
struct StereoFrame {
  double left_stamp = 0.0, right_stamp = 0.0;  ///< [s]
  std::shared_ptr<const Image> left, right;
};
/// A stereo pair of cameras that are a model.
struct EstimateFrame {
  double stamp = 0.0;  ///< [s], of the left one
  /// Pose, motion, localization and landmarks are what it tells; stamps are those of its making.
  std::shared_ptr<const Belief> belief;
};
struct DepthFrame {
  double stamp = 0.0;  ///< [s]
  std::shared_ptr<const DepthImage> image;
  int sensor = 0;  ///< which of RobotDescription::depth_sensors() it is of
};
struct ScanFrame {
  double stamp = 0.0;                     ///< [s]
  std::shared_ptr<const DepthScan> in_B;  ///< origin and points in B [m]
  std::shared_ptr<const Pose> pose{};  ///< B's then, of a sensor that tells it; null: it does not
  int sensor = 0;                      ///< which of RobotDescription::depth_sensors() it is of
};

/// What a robot's sensors deliver: one input of perception. A pose is one that something else has
/// measured: a localization, motion capture. A correction is of who keeps the map.
using SensorFrame = std::variant<StereoFrame, WheelSample, DepthFrame, ScanFrame, EstimateFrame,
                                 ExternalPose, Correction, ImuSample>;
/// Of the left image of a pair.
double stamp_of(const SensorFrame& frame);
/// Hands it to perception; the result is perception's, which refuses an estimate.
InputResult feed(PerceptionPipeline& perception, const SensorFrame& frame);

}  // namespace prospect
