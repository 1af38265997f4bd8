// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/feature_sensors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "adapters/robots/simulator/depth_cameras.h"
#include "adapters/robots/simulator/noise_stream.h"
#include "adapters/robots/simulator/relocalization.h"
#include "adapters/robots/simulator/view_features.h"
#include "engine/maps/planar_error.h"
#include "perception/mapping/anchored_map.h"
#ifdef PROSPECT_LOOPS
#include "perception/places/map_loops.h"
#endif

namespace prospect {
namespace {

LandmarkBuilderOptions landmarks_of(const SimulatorOptions& options,
                                    const PerceptionOptions& perception) {
  LandmarkBuilderOptions landmarks = options.landmarks;
  landmarks.density = perception.feature_density;
  return landmarks;
}

}  // namespace

/// What keeps the map straight.
struct FeatureSensors::Loops {
  AnchoredMap map;
  Pose last;             // estimated, of the newest scan
  double way = 0.0;      // [m] since the anchor began, a radian as kMetresPerRadian
  int before_loss = -1;  // anchor; -1: not lost
  std::vector<Followed> followed{};
  Eigen::Matrix3d sure;  // of (x, y, yaw) at the origin of the anchor `sure_at`, from the start
  int sure_at = -1;      // -1: as odometry says
#ifdef PROSPECT_LOOPS
  MapLoops loops;

  Loops(const std::shared_ptr<OccupancyMapper>& mapper, const Pose& start, bool aligns)
      : map(mapper, start), last(start), loops(aligns) {}
#endif
};

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
      scan_stamps_(depth_.size(), 0.0) {
  const bool corrected =
      std::any_of(options.corrections.begin(), options.corrections.end(),
                  [](const auto& c) { return c.kind == CorrectionKind::kRobot; });
  if (options.loops || corrected) {
#ifdef PROSPECT_LOOPS
    loops_ = std::make_unique<Loops>(mapper_, start, options.loops);
#else
    throw std::invalid_argument("simulator: loops and corrections of the robot need Ceres");
#endif
  }
  if (options.map) mapper_->load(*options.map);
  const double z = start.position.z();
  for (const Disc& d : known_free) {
    mapper_->clear_cylinder({d.center.x(), d.center.y(), z}, d.radius,
                            perception.mapping.slice.z_max - z);
  }
  mapper_->assume_floor(start.position.head<2>(), perception.start_floor);
}

void FeatureSensors::scan(double stamp, const Pose& true_pose, SeenArea& seen) {
  for (std::size_t n = 0; n < depth_.size(); ++n) {
    ScanFrame frame;
    frame.stamp = stamp;
    frame.in_B = std::make_shared<const DepthScan>(seen.look(depth_[n], true_pose));
    frame.pose = std::make_shared<const Pose>(odometry_.estimate(true_pose));
    frame.sensor = static_cast<int>(n);
    deliver(frame);
    if (enters_ranges_) enter(stamp, frame);
  }
  keep_straight(stamp, true_pose);
}

void FeatureSensors::begin_anchor(const Pose& true_pose, std::optional<int> parent) {
  const Eigen::Vector3i planar(0, 1, 3);
  loops_->map.begin(odometry_.estimate(true_pose), odometry_.covariance(true_pose)(planar, planar),
                    parent);
  loops_->last = odometry_.estimate(true_pose);
  loops_->way = 0.0;
}

void FeatureSensors::keep_straight([[maybe_unused]] double stamp, const Pose& true_pose) {
  if (!loops_) return;
  constexpr double kAnchorWay = 2.5, kMetresPerRadian = 0.3;  // [m], [m/rad]
  const Pose now = odometry_.estimate(true_pose);
  loops_->way += (now.position - loops_->last.position).head<2>().norm() +
                 kMetresPerRadian * std::abs(now.yaw - loops_->last.yaw);
  loops_->last = now;
  if (loops_->way >= kAnchorWay) begin_anchor(true_pose);
  loops_->map.note(now);
#ifdef PROSPECT_LOOPS
  auto done = loops_->loops.go_on(loops_->map, stamp);
  if (!done) return;
  landmarks_.follow(done->moved.anchors);
  loops_->sure = done->covariance;
  loops_->sure_at = done->sure_at;
  loops_->followed.push_back({std::move(done->correction), std::move(done->moved.places)});
#endif
}

Eigen::Matrix4d FeatureSensors::covariance(const Pose& true_pose) const {
  const Eigen::Matrix4d by_odometry = odometry_.covariance(true_pose);
  if (!loops_ || loops_->sure_at < 0) return by_odometry;
  const Eigen::Vector3i planar(0, 1, 3);
  const MapAnchor& at = loops_->map.anchors()[static_cast<std::size_t>(loops_->sure_at)];
  const Eigen::Vector2d way =
      (odometry_.estimate(true_pose).position - at.origin.position).head<2>();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  covariance(planar, planar) =
      carried(loops_->sure, way) + added(at.covariance, way, by_odometry(planar, planar));
  return 0.5 * (covariance + covariance.transpose());
}

std::vector<SimulatedSensors::Followed> FeatureSensors::followed() {
  return loops_ ? std::exchange(loops_->followed, {}) : std::vector<Followed>();
}

bool FeatureSensors::move_robot([[maybe_unused]] const Correction& correction,
                                [[maybe_unused]] const Pose& true_pose) {
#ifdef PROSPECT_LOOPS
  if (loops_) {
    const Eigen::Vector3i planar(0, 1, 3);
    const Pose robot = odometry_.estimate(true_pose);
    if (!loops_->loops.move_robot(loops_->map, robot,
                                  odometry_.covariance(true_pose)(planar, planar), correction)) {
      return false;
    }
    loops_->last = robot;
    loops_->way = 0.0;
    return true;
  }
#endif
  return false;
}

PlanarMove FeatureSensors::origin() const {
#ifdef PROSPECT_LOOPS
  if (loops_) return loops_->loops.origin();
#endif
  return {};
}

const AnchoredMap* FeatureSensors::anchored() const { return loops_ ? &loops_->map : nullptr; }

const MapLoops* FeatureSensors::loops() const {
#ifdef PROSPECT_LOOPS
  if (loops_) return &loops_->loops;
#endif
  return nullptr;
}

void FeatureSensors::enter(double stamp, const SensorFrame& ranges) {
  const auto* scan = std::get_if<ScanFrame>(&ranges);
  if (!scan || !scan->pose || scan->sensor >= static_cast<int>(depth_.size())) return;
  // A robot's ranges are as old as those of the sensor that is farthest behind.
  scan_stamps_[static_cast<std::size_t>(scan->sensor)] = stamp;
  scan_stamp_ = *std::min_element(scan_stamps_.begin(), scan_stamps_.end());
  mapper_->insert(transform(*scan->in_B, *scan->pose));
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
  if (loops_ && !was_lost && odometry_.localization() == Localization::kLost) {
    // Of several losses before the place is found, the first.
    if (loops_->before_loss < 0) loops_->before_loss = loops_->map.open().id;
    begin_anchor(pose);
  }
  find_place_again(pose, observations);
  // New points would carry the error of the loss.
  if (relocalization_images_left_ > 0) return;
  if ((keyframe || first) && odometry_.localization() != Localization::kLost) {
    const double r = mapper_->options().resolution;
    landmarks_.update(observations, odometry_.estimate(pose), *mapper_->voxels(),
                      static_cast<double>(mapper_->surface_voxels()) * r * r,
                      loops_ ? loops_->map.open().id : 0);
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
    if (loops_ && loops_->before_loss >= 0) begin_anchor(pose, loops_->before_loss);
  } else if (relocalization_images_left_ == 0) {
    odometry_.accept_drift();
  }
  if (loops_ && relocalization_images_left_ == 0) loops_->before_loss = -1;
}

std::shared_ptr<const Belief> FeatureSensors::belief(double stamp, const Pose& true_pose,
                                                     const Twist& commanded) {
  auto belief = std::make_shared<Belief>();
  belief->stamp = stamp;
  // The estimate follows the wheels to this very instant.
  belief->stamps = {stamp, scan_stamp_, image_stamp_, scan_stamp_};
  belief->pose = odometry_.estimate(true_pose);
  belief->covariance = covariance(true_pose);
  belief->twist = commanded;
  belief->localization = odometry_.localization();
  belief->tracked_features = tracked_;
  belief->octree = mapper_->octree();
  belief->voxels = mapper_->voxels();
  belief->ground = mapper_->ground();
  belief->landmarks = landmarks_.map();
  return belief;
}

Pose FeatureSensors::estimate(double, const Pose& true_pose) const {
  return odometry_.estimate(true_pose);
}

}  // namespace prospect
