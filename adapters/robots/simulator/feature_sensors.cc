// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/feature_sensors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>
#include <vector>

#include "adapters/robots/simulator/depth_cameras.h"
#include "adapters/robots/simulator/known_free.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/relocalization.h"
#include "adapters/robots/simulator/view_features.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

LandmarkBuilderOptions landmarks_of(const SimulatorOptions& options,
                                    const PerceptionOptions& perception) {
  LandmarkBuilderOptions landmarks = options.landmarks;
  landmarks.density = perception.feature_density;
  return landmarks;
}

}  // namespace

FeatureSensors::~FeatureSensors() = default;

FeatureSensors::FeatureSensors(const World& world, const SimulatorOptions& options,
                               const PerceptionOptions& perception, const Pose& start,
                               const std::vector<Disc>& known_free)
    : stereo_(options.features.stereo),
      stereo_mount_(options.stereo_mount),
      depth_(depth_cameras(world, options)),
      field_(tracked_field(world, options)),
      camera_(world, field_, options.features, options.stereo_mount,
              stream_seed(options.seed, NoiseStream::kFeatures)),
      odometry_(options.odometry, options.features.stereo, options.stereo_mount, start,
                stream_seed(options.seed, NoiseStream::kOdometry)),
      landmarks_(landmarks_of(options, perception), options.features, options.stereo_mount),
      mapper_(std::make_shared<OccupancyMapper>(perception.mapping)),
      movers_(perception.movers),
      base_height_(options.base_height),
      scan_stamps_(depth_.size(), 0.0) {
  const bool corrected =
      std::any_of(options.corrections.begin(), options.corrections.end(),
                  [](const auto& c) { return c.kind == CorrectionKind::kRobot; });
  // A way that is true cannot be straightened: all that changed it would be errors of the loops.
  const bool is_true = options.odometry.perfect && options.place_known;
  const bool aligns = perception.loops && StraightMap::is_built_in() && !is_true;
  if (aligns || corrected) straight_ = std::make_unique<StraightMap>(mapper_, start, aligns);
  if (!options.corrections.empty()) corrections_.expect();
  if (options.map) {
    mapper_->load(*options.map);
    check_parameter(options.place_known || straight_, "simulator", "place_known", 0.0,
                    "with perception.loops, built with Ceres");
    if (straight_) straight_->give({start, Eigen::Matrix3d::Zero()}, options.place_known);
  }
  free_height_ = perception.mapping.slice.z_max - start.position.z();
  clear_free(*mapper_, known_free, start.position.z(), free_height_);
  mapper_->assume_floor(start.position.head<2>(), perception.start_floor);
}

void FeatureSensors::scan(double stamp, const Pose& true_pose, SeenArea& seen) {
  for (std::size_t n = 0; n < depth_.size(); ++n) {
    ScanFrame frame;
    frame.stamp = stamp;
    frame.in_B = std::make_shared<const DepthScan>(seen.look(depth_[n], true_pose, walkers()));
    frame.pose = std::make_shared<const Pose>(odometry_.estimate(true_pose));
    frame.sensor = static_cast<int>(n);
    deliver(frame);
    if (enters_ranges_) enter(stamp, frame);
  }
  keep_straight(stamp, true_pose);
}

StraightMap::Robot FeatureSensors::robot(const Pose& true_pose) const {
  const Eigen::Vector3i planar(0, 1, 3);
  return {odometry_.estimate(true_pose), odometry_.covariance(true_pose)(planar, planar)};
}

void FeatureSensors::keep_straight(double stamp, const Pose& true_pose) {
  if (!straight_) return;
  const auto done = go_on(*straight_, stamp, robot(true_pose), corrections_);
  if (done) landmarks_.follow(done->anchors);
}

Eigen::Matrix4d FeatureSensors::covariance(const Pose& true_pose) const {
  Eigen::Matrix4d covariance = odometry_.covariance(true_pose);
  if (!straight_) return covariance;
  const Eigen::Vector3i planar(0, 1, 3);
  covariance(planar, planar) = straight_->covariance(robot(true_pose));
  return covariance;
}

void FeatureSensors::carry(const Pose& from, const Pose& true_pose,
                           const std::vector<Disc>& known_free) {
  odometry_.carry(from, true_pose);
  const Pose now = odometry_.estimate(true_pose);
  if (straight_) straight_->lift(robot(true_pose));
  landmarks_.forget();
  relocalization_images_left_ = 0;
  before_loss_ = -1;
  clear_free(*mapper_, known_free, now.position.z(), free_height_, move_between(true_pose, now));
}

void FeatureSensors::correct(const Correction& correction, const Pose& true_pose) {
  prospect::correct(correction, robot(true_pose), corrections_, straight_.get());
}

PlanarMove FeatureSensors::origin() const { return straight_ ? straight_->origin() : PlanarMove{}; }

void FeatureSensors::enter(double stamp, const SensorFrame& ranges) {
  const auto* scan = std::get_if<ScanFrame>(&ranges);
  if (!scan || !scan->pose || scan->sensor >= static_cast<int>(depth_.size())) return;
  // A robot's ranges are as old as those of the sensor that is farthest behind.
  scan_stamps_[static_cast<std::size_t>(scan->sensor)] = stamp;
  scan_stamp_ = *std::min_element(scan_stamps_.begin(), scan_stamps_.end());
  DepthScan in_W = transform(*scan->in_B, *scan->pose);
  movers_.look(stamp, *mapper_, in_W);
  mapper_->insert(in_W);
}

void FeatureSensors::image(double stamp, const Pose& pose, const Twist&) {
  image_stamp_ = stamp;
  // A robot that stands still sees what it saw.
  if (any_image_ && pose.yaw == image_pose_.yaw && pose.position == image_pose_.position) return;
  const bool first = !any_image_;
  any_image_ = true;
  image_pose_ = pose;
  const std::vector<FeatureObservation> observations = camera_.observe(pose);
  tracked_ = static_cast<int>(observations.size());
  std::vector<Eigen::Vector3d> points;
  points.reserve(observations.size());
  for (const FeatureObservation& o : observations) points.push_back(o.true_point);
  const bool was_lost = odometry_.localization() == Localization::kLost;
  const bool keyframe = odometry_.image(pose, points);
  if (straight_ && !was_lost && odometry_.localization() == Localization::kLost) {
    // Of several losses before the place is found, the first.
    if (before_loss_ < 0) before_loss_ = straight_->open_anchor();
    straight_->begin_anchor(robot(pose));
  }
  find_place_again(pose, observations);
  // New points would carry the error of the loss.
  if (relocalization_images_left_ > 0) return;
  if ((keyframe || first) && odometry_.localization() != Localization::kLost) {
    const double r = mapper_->options().resolution;
    landmarks_.update(observations, odometry_.estimate(pose), *mapper_->voxels(),
                      static_cast<double>(mapper_->surface_voxels()) * r * r,
                      straight_ ? straight_->open_anchor() : 0);
  }
}

// Points seen before a loss are looked for until they are found or given up.
void FeatureSensors::find_place_again(const Pose& pose,
                                      const std::vector<FeatureObservation>& observations) {
  constexpr int kImages = 30;
  if (odometry_.localization() == Localization::kLost) {
    relocalization_images_left_ = kImages;
    return;
  }
  if (relocalization_images_left_ == 0) return;
  --relocalization_images_left_;
  const auto find = [this](std::uint32_t feature) { return landmarks_.find(feature); };
  const Eigen::Vector3i planar(0, 1, 3);
  const Eigen::Matrix3d drift = odometry_.drift_covariance()(planar, planar);
  const auto found = relocalize(observations, find, stereo_, stereo_mount_,
                                odometry_.estimate(pose), drift.inverse());
  if (found) {
    odometry_.relocalize(pose, found->pose, found->covariance);
    relocalization_images_left_ = 0;
    if (before_loss_ >= 0) straight_->begin_anchor(robot(pose), before_loss_);
  } else if (relocalization_images_left_ == 0) {
    odometry_.accept_drift();
  }
  if (relocalization_images_left_ == 0) before_loss_ = -1;
}

std::shared_ptr<const Belief> FeatureSensors::belief(double stamp, const Pose& true_pose,
                                                     const Twist& commanded) {
  auto belief = std::make_shared<Belief>();
  belief->stamp = stamp;
  // The estimate follows the wheels to this very instant.
  belief->stamps = {stamp, scan_stamp_, image_stamp_, scan_stamp_};
  belief->pose = estimate(stamp, true_pose);
  belief->covariance = covariance(true_pose);
  belief->twist = commanded;
  belief->localization = odometry_.localization();
  belief->tracked_features = tracked_;
  belief->octree = mapper_->octree();
  belief->voxels = mapper_->voxels();
  belief->ground = mapper_->ground();
  belief->landmarks = landmarks_.map();
  belief->movers = movers_.movers(stamp);
  belief->map_frame = corrections_.frame();
  return belief;
}

// Heights of beliefs are those over the floor.
Pose FeatureSensors::estimate(double, const Pose& true_pose) const {
  Pose pose = odometry_.estimate(true_pose);
  pose.position.z() = base_height_;
  return pose;
}

}  // namespace prospect
