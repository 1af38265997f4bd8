#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <unordered_set>
#include <vector>

#include "adapters/simulator/camera_rig.h"
#include "adapters/simulator/depth_camera.h"
#include "adapters/simulator/sensors.h"
#include "adapters/simulator/simulator_options.h"
#include "adapters/worlds/world.h"
#include "models/robot_shape.h"
#include "perception/fusion/visual_motion.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/odometry/stereo_odometry.h"
#include "perception/pipeline/belief_builder.h"
#include "perception/pipeline/depth_agreement.h"
#include "perception/pipeline/feature_density.h"
#include "perception/pipeline/landmark_memory.h"

namespace prospect {

/// Perception as it runs on a robot: rendered stereo pairs through StereoOdometry, fused with
/// wheels, rendered depth through DepthMapper. Nothing but the pose at the start is taken from the
/// truth.
///
/// Wheels say of every time between two images the mean velocity of the body in it, v and w, times
/// scales drawn once, N(1, sigma_scale^2), plus noise of the variances that WheelFusionOptions
/// gives: (along^2 |v|, across^2 |v|) / dt and (turn^2 |w| + heading^2 |v|) / dt.
///
/// Stereo pair and depth camera are held against each other wherever they look at the same time
/// (depth_agreement.h). As long as they disagree about the metre, localization by the images is
/// lost, from the next image on; as long as vision and wheels do, localization is (WheelFusion).
/// complaint() says why.
///
/// feature_density counts as new landmarks those in cells of 0.15 m, what an image cell shows 2 m
/// away, that held none before: on an edge corners are found anew in every view.
///
/// Bits: the same for any number of threads of the renderer. Source: our choice.
class CameraSensors final : public SimulatedSensors {
 public:
  /// As FeatureSensors. Throws std::invalid_argument on options out of range, NotBuiltIn without a
  /// renderer.
  CameraSensors(const World& world, const SimulatorOptions& options,
                const OccupancyMapperOptions& mapping, const Pose& start,
                const std::vector<Disc>& known_free);

  void image(double stamp, const Pose& true_pose, const Twist& twist) override;
  void scan(double stamp, const Pose& true_pose, SeenArea& seen) override;
  std::shared_ptr<const Belief> belief(double stamp, const Pose& true_pose,
                                       const Twist& commanded) override;
  Pose estimate(double stamp, const Pose& true_pose) const override;
  Localization localization() const override { return frame_.state; }
  int losses() const override { return losses_; }
  std::string complaint() const override;
  CameraPicture picture() const override;

 private:
  WheelSample wheels(double stamp, const Pose& true_pose);
  Pose visual_pose() const;
  void count_landmarks();
  /// Holds the newest frame against the newest depth image, if they are of one time.
  void compare();
  /// Empty, or that they disagree.
  std::string disagreement() const;
  void doubt();

  SimulatorOptions options_;
  CameraRig rig_;
  DepthCamera looking_;  ///< what the depth camera's rays pass in truth, for evaluation
  StereoOdometry odometry_;
  VisualMotionReader reader_;
  WheelFusion fusion_;
  DepthMapper mapper_;
  BeliefBuilder builder_;
  LandmarkMemory memory_;
  FeatureDensity density_;
  std::unordered_set<std::uint64_t> places_;  // cells that have held a landmark

  std::uint64_t images_ = 0, scans_ = 0;
  ImagePair pair_;
  OdometryFrame frame_;
  Pose pose_at_fix_;  ///< fused, when the odometry last took a pose
  int losses_ = 0;
  double height_ = 0.0;     // of B's origin [m]
  double map_stamp_ = 0.0;  // [s], of the newest scan that the map took in
  DepthImage depth_;
  double depth_stamp_ = -1.0;  // [s]
  ScaleAgreement agreement_;   // of the newest pair of images that says something

  std::mt19937_64 wheel_noise_;
  double wheel_scale_ = 1.0, turn_scale_ = 1.0;
  double wheel_stamp_ = 0.0;
  Pose wheel_pose_;  // true, at the last sample
};

}  // namespace prospect
