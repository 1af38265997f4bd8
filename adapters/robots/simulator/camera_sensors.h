// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "adapters/formats/worlds/textured_mesh.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/camera_rig.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/exposure_control.h"
#include "adapters/robots/simulator/people.h"
#include "adapters/robots/simulator/sensors.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "models/image.h"
#include "models/robot_shape.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pipeline/perception_pipeline.h"

namespace prospect {

/// What the cameras of a simulation see of a world: its own mesh, else that of its voxels with the
/// marks that belong to the seed. Throws as world_mesh().
TexturedMesh seen_mesh(const World& world, const SimulatorOptions& options);

/// Perception as it runs on a robot: rendered stereo pairs, rendered depth and what wheels measure
/// through PerceptionPipeline. Nothing but the pose at the start is taken from the truth.
///
/// Wheels say of every time between two images the mean velocity of the body in it, v and w, times
/// scales drawn once, N(1, sigma_scale^2), plus noise of the variances that WheelNoise gives:
/// (along^2 |v|, across^2 |v|) / dt and (turn^2 |w| + heading^2 |v|) / dt.
///
/// Depth sensors besides the first are rendered, too, up to 170 degrees wide; wider ones are
/// lidars, whose rays meet the world's voxels.
///
/// With realism the images are those of other cameras than the robot believes in, in another light
/// (camera_effects.h), and people walk through them (people.h).
///
/// An IMU (SimulatedImu) is held against the images.
///
/// Inputs arrive at once, so no depth image waits for a pose, but after leave_ranges(). A
/// robot that is to use no wheels holds its pose while it is lost.
///
/// Bits: the same for any number of threads of the renderer. Source: our choice.
class CameraSensors final : public SimulatedSensors {
 public:
  /// As FeatureSensors. Throws std::invalid_argument on options out of range, NotBuiltIn without a
  /// renderer.
  CameraSensors(const World& world, const SimulatorOptions& options,
                const PerceptionOptions& perception, const Pose& start,
                const std::vector<Disc>& known_free);

  void image(double stamp, const Pose& true_pose, const Twist& twist) override;
  void scan(double stamp, const Pose& true_pose, SeenArea& seen) override;
  void imu(const ImuSample& sample) override;
  void enter(double stamp, const SensorFrame& ranges) override;
  std::shared_ptr<const Belief> belief(double stamp, const Pose& true_pose,
                                       const Twist& commanded) override;
  Pose estimate(double stamp, const Pose& true_pose) const override;
  Localization localization() const override { return perception_.frame().state; }
  int losses() const override { return losses_; }
  void carry(const Pose& from, const Pose& true_pose, const std::vector<Disc>& known_free) override;
  void correct(const Correction& correction, const Pose& true_pose) override;
  PlanarMove origin() const override;
  std::string complaint() const override { return perception_.complaint(); }
  CameraPicture picture() const override;

 private:
  WheelSample wheels(double stamp, const Pose& true_pose);

  SimulatorOptions options_;
  CameraRig rig_;
  std::map<int, CameraRig> more_;  ///< of depth cameras besides the first, by their number
  /// What rays of each depth sensor pass in truth, for evaluation; of those that no image in
  /// perspective holds also what they measure.
  std::vector<DepthCamera> looking_;
  ExposureControl exposure_;
  People people_;
  bool has_wheels_;
  PerceptionPipeline perception_;

  std::uint64_t images_ = 0, scans_ = 0;
  StereoFrame pair_;  // the newest
  int losses_ = 0;

  std::mt19937_64 wheel_noise_;
  double wheel_scale_ = 1.0, turn_scale_ = 1.0;
  double wheel_stamp_ = 0.0;
  Pose wheel_pose_;           // true, at the last sample
  double free_height_ = 0.0;  // [m] above B's origin
};

}  // namespace prospect
