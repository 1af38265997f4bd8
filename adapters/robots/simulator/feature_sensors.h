// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/feature_camera.h"
#include "adapters/robots/simulator/feature_field.h"
#include "adapters/robots/simulator/landmark_builder.h"
#include "adapters/robots/simulator/odometry_model.h"
#include "adapters/robots/simulator/sensors.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/maps/correction.h"
#include "models/robot_shape.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/pipeline/straight_map.h"

namespace prospect {

/// Perception as a model, fast: features that are visible are tracked, the estimate drifts with how
/// many there are (OdometryModel), is found again in the map of landmarks after a loss, and depth
/// rays are cast through the true voxels.
class FeatureSensors final : public SimulatedSensors {
 public:
  /// perception: its `mapping` has what it takes from the robot (mapping_options()).
  /// known_free: discs in W [m] over which columns of the map are known to be free up to
  /// mapping.slice.z_max, by their centres (known_free.h). Throws std::invalid_argument on options
  /// out of range.
  FeatureSensors(const World& world, const SimulatorOptions& options,
                 const PerceptionOptions& perception, const Pose& start,
                 const std::vector<Disc>& known_free);
  ~FeatureSensors() override;

  void image(double stamp, const Pose& true_pose, const Twist& twist) override;
  void scan(double stamp, const Pose& true_pose, SeenArea& seen) override;
  void enter(double stamp, const SensorFrame& ranges) override;
  std::shared_ptr<const Belief> belief(double stamp, const Pose& true_pose,
                                       const Twist& commanded) override;
  Pose estimate(double stamp, const Pose& true_pose) const override;
  Localization localization() const override { return odometry_.localization(); }
  int losses() const override { return odometry_.losses(); }
  void carry(const Pose& from, const Pose& true_pose, const std::vector<Disc>& known_free) override;
  void correct(const Correction& correction, const Pose& true_pose) override;
  PlanarMove origin() const override;

  /// What keeps the map straight, for evaluation; null: nothing does.
  const StraightMap* straight_map() const { return straight_.get(); }

 private:
  StraightMap::Robot robot(const Pose& true_pose) const;
  void keep_straight(double stamp, const Pose& true_pose);
  /// Of the estimate's error in (x, y, z, yaw), with what loops have taken back of it.
  Eigen::Matrix4d covariance(const Pose& true_pose) const;
  void find_place_again(const Pose& pose, const std::vector<FeatureObservation>& observations);

  StereoCamera stereo_;
  CameraMount stereo_mount_;
  std::vector<DepthCamera> depth_;  // a sensor each
  FeatureField field_;
  FeatureCamera camera_;
  OdometryModel odometry_;
  LandmarkBuilder landmarks_;
  std::shared_ptr<OccupancyMapper> mapper_;
  MoverTracker movers_;
  double base_height_;                     // [m] of B's origin over the floor
  std::unique_ptr<StraightMap> straight_;  // null: the map is as it was drawn
  int before_loss_ = -1;                   // anchor; -1: not lost
  Corrections corrections_;
  double free_height_ = 0.0;  // [m] above B's origin

  std::vector<double> scan_stamps_;              // [s], of each depth sensor
  double scan_stamp_ = 0.0, image_stamp_ = 0.0;  // [s], of the newest
  bool any_image_ = false;
  Pose image_pose_;  // true pose of the newest image
  int tracked_ = 0;
  int relocalization_images_left_ = 0;
};

}  // namespace prospect
