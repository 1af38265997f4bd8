#include "adapters/simulator/camera_sensors.h"

#include <cmath>
#include <optional>
#include <utility>

#include "adapters/simulator/feature_field.h"
#include "adapters/simulator/noise_stream.h"
#include "adapters/simulator/scene_renderer.h"
#include "adapters/simulator/world_mesh.h"
#include "models/sinc.h"
#include "perception/odometry/body_pose.h"
#include "perception/odometry/lattice_cell.h"
#include "perception/odometry/reason.h"

namespace prospect {
namespace {

std::shared_ptr<const SceneRenderer> scene_of(const World& world, const SimulatorOptions& options) {
  if (world.mesh) {
    SceneRendererOptions as_read;
    as_read.texture_contrast = options.camera.texture_quality;
    return std::make_shared<const SceneRenderer>(*world.mesh, as_read);
  }
  WorldMeshOptions mesh;
  mesh.texture_quality = options.camera.texture_quality;
  mesh.seed = stream_seed(options.seed, NoiseStream::kTexture);
  return std::make_shared<const SceneRenderer>(
      world_mesh(world, simulated_features(world, options.seed), mesh));
}

CameraRigOptions rig_of(const SimulatorOptions& options) {
  CameraRigOptions rig = options.camera.rig;
  rig.stereo = options.features.stereo;
  rig.stereo_mount = options.stereo_mount;
  rig.footprint = options.depth.footprint;
  rig.depth_mount = options.depth_mount;
  rig.depth_noise_constant = options.depth.noise_constant;
  rig.depth_noise_quadratic = options.depth.noise_quadratic;
  rig.depth_dropout = options.depth.dropout;
  rig.seed = stream_seed(options.seed, NoiseStream::kImages);
  return rig;
}

DepthMapperOptions mapper_of(const SimulatorOptions& options,
                             const OccupancyMapperOptions& mapping) {
  DepthMapperOptions mapper;
  mapper.map = mapping;
  mapper.range = {options.depth.footprint.min_range, options.depth.footprint.max_range};
  return mapper;
}

/// The stereo pair as the robot takes it to be.
StereoCamera believed(const SimulatorOptions& options) {
  const CameraSensorsOptions& errors = options.camera;
  StereoCamera camera = options.features.stereo;
  camera.left.fx *= 1.0 + errors.focal_error;
  camera.left.fy *= 1.0 + errors.focal_error;
  camera.baseline *= 1.0 + errors.baseline_error;
  return camera;
}

WheelFusionOptions fusion_of(const SimulatorOptions& options, const Pose& start) {
  WheelFusionOptions fusion = options.camera.wheel_fusion;
  fusion.start = start;
  return fusion;
}

}  // namespace

CameraSensors::CameraSensors(const World& world, const SimulatorOptions& options,
                             const OccupancyMapperOptions& mapping, const Pose& start,
                             const std::vector<Disc>& known_free)
    : options_(options),
      rig_(scene_of(world, options), rig_of(options)),
      looking_(world, options.depth, options.depth_mount,
               stream_seed(options.seed, NoiseStream::kDepth)),
      odometry_(believed(options), options.camera.odometry,
                camera_pose(start, options.stereo_mount)),
      reader_(options.stereo_mount.T_BC),
      fusion_(fusion_of(options, start)),
      mapper_(rig_.depth_camera(), mapper_of(options, mapping)),
      builder_(options.stereo_mount.T_BC),
      pose_at_fix_(start),
      height_(start.position.z()),
      wheel_noise_(stream_seed(options.seed, NoiseStream::kWheels)),
      wheel_pose_(start) {
  frame_.T_WC = camera_pose(start, options.stereo_mount);
  if (options.map) mapper_.map().load(*options.map);
  const double z = start.position.z();
  for (const Disc& d : known_free) {
    mapper_.map().clear_cylinder({d.center.x(), d.center.y(), z}, d.radius,
                                 mapping.slice.z_max - z);
  }
  std::normal_distribution<double> normal;
  wheel_scale_ += options.camera.wheel_fusion.sigma_scale * normal(wheel_noise_);
  turn_scale_ += options.camera.wheel_fusion.sigma_scale * normal(wheel_noise_);
}

WheelSample CameraSensors::wheels(double stamp, const Pose& true_pose) {
  const WheelFusionOptions& errors = options_.camera.wheel_fusion;
  const double dt = stamp - wheel_stamp_;
  const double turn = std::remainder(true_pose.yaw - wheel_pose_.yaw, 2.0 * M_PI);
  // p' = p + dt sinc(turn / 2) R(yaw + turn / 2) v
  const Eigen::Vector2d v = Eigen::Rotation2Dd(-(wheel_pose_.yaw + 0.5 * turn)) *
                            (true_pose.position - wheel_pose_.position).head<2>() /
                            (dt * sinc(0.5 * turn));
  const double speed = v.norm(), w = turn / dt;
  std::normal_distribution<double> normal;
  const double noise_along = normal(wheel_noise_), noise_across = normal(wheel_noise_),
               noise_turn = normal(wheel_noise_);
  const double root = std::sqrt(speed / dt);
  const Eigen::Vector2d forward = speed > 0.0 ? Eigen::Vector2d(v / speed) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d aside(-forward.y(), forward.x());
  WheelSample sample;
  sample.stamp = stamp;
  sample.velocity =
      (v + root * (errors.along * noise_along * forward + errors.across * noise_across * aside)) /
      wheel_scale_;
  sample.yaw_rate = (w + std::sqrt((errors.turn * errors.turn * std::abs(w) +
                                    errors.heading * errors.heading * speed) /
                                   dt) *
                             noise_turn) /
                    turn_scale_;
  wheel_stamp_ = stamp;
  wheel_pose_ = true_pose;
  return sample;
}

void CameraSensors::image(double stamp, const Pose& true_pose, const Twist& twist) {
  pair_ = rig_.stereo(true_pose, twist, images_++);
  if (stamp > wheel_stamp_) fusion_.add(wheels(stamp, true_pose));
  const bool was_lost = images_ > 1 && frame_.state == Localization::kLost;
  std::optional<Eigen::Isometry3d> motion;
  if (options_.camera.wheels) {
    motion = reader_.camera_motion(pose_at_fix_, fusion_.at(stamp).pose);
  }
  frame_ = odometry_.process(stamp, pair_.left.view(), pair_.right.view(), motion);
  const bool taken = frame_.tracked > 0 && frame_.state != Localization::kLost;
  compare();
  doubt();
  fusion_.add(reader_.read(frame_));
  if (taken) pose_at_fix_ = fusion_.at(stamp).pose;
  losses_ += frame_.state == Localization::kLost && !was_lost;
  if (frame_.keyframe) count_landmarks();
}

void CameraSensors::compare() {
  if (depth_stamp_ != frame_.stamp || images_ == 0) return;
  std::unordered_set<std::uint64_t> tracked;
  for (const LandmarkSighting& s : odometry_.sightings()) {
    if (s.tracked) tracked.insert(s.id);
  }
  const Eigen::Isometry3d T_CW = frame_.T_WC.inverse();
  std::vector<Eigen::Vector3d> points;
  const std::shared_ptr<const LandmarkMap> map = odometry_.landmarks();
  for (const Landmark& l : map->landmarks) {
    if (tracked.count(l.id) > 0) points.push_back(T_CW * l.position);
  }
  const StereoCamera camera = believed(options_);
  DepthAgreementOptions agreement;
  agreement.range = {options_.depth.footprint.min_range, options_.depth.footprint.max_range};
  const ScaleAgreement found = depth_agreement(
      points, frame_.disparity_offset_sigma / (camera.left.fx * camera.baseline),
      rig_.depth_camera(), options_.stereo_mount.T_BC.inverse() * options_.depth_mount.T_BC, depth_,
      agreement);
  if (found.verdict != ScaleAgreement::Verdict::kUnknown) agreement_ = found;
}

std::string CameraSensors::disagreement() const {
  if (agreement_.verdict != ScaleAgreement::Verdict::kDisagree) return {};
  return to_string(agreement_, "depths by the stereo pair are", "those of the depth camera") +
         "; expected the same: the baseline or focal length of the pair, or the depth camera's "
         "unit, is wrong";
}

std::string CameraSensors::complaint() const {
  const std::string depths = disagreement();
  if (!depths.empty() || !options_.camera.wheels) return depths;
  const FusedOdometry fused = fusion_.at(frame_.stamp);
  return fused.agreement.verdict == ScaleAgreement::Verdict::kDisagree ? fused.reason : "";
}

void CameraSensors::doubt() {
  const std::string why = disagreement();
  if (why.empty()) return;
  frame_.state = Localization::kLost;
  add_reason(frame_.reason, why);
}

void CameraSensors::count_landmarks() {
  constexpr double kPlace = 0.15;  // [m]
  int anew = 0;
  const auto map = odometry_.landmarks();
  for (const Landmark& l : map->landmarks) {
    anew += places_.insert(lattice_cell(l.position, kPlace)).second;
  }
  const double r = options_.mapping.resolution;
  density_.add(anew, static_cast<double>(mapper_.map().surface_voxels()) * r * r);
}

Pose CameraSensors::visual_pose() const {
  Pose pose = body_pose(frame_.T_WC * options_.stereo_mount.T_BC.inverse());
  pose.position.z() = height_;
  return pose;
}

Pose CameraSensors::estimate(double stamp, const Pose&) const {
  Pose pose = options_.camera.wheels ? fusion_.at(stamp).pose : visual_pose();
  pose.position.z() = height_;
  return pose;
}

void CameraSensors::scan(double stamp, const Pose& true_pose, SeenArea& seen) {
  seen.look(looking_, true_pose);
  depth_ = rig_.depth(true_pose, scans_++);
  depth_stamp_ = stamp;
  compare();
  const MappedFrame mapped =
      mapper_.process(stamp, depth_, camera_pose(estimate(stamp, true_pose), options_.depth_mount));
  if (mapped.state != Mapping::kRejected) map_stamp_ = stamp;
}

std::shared_ptr<const Belief> CameraSensors::belief(double stamp, const Pose&, const Twist&) {
  // Of the next image: those that are lost later on are detected again.
  auto landmarks = std::make_shared<LandmarkMap>(*odometry_.landmarks(0.0));
  landmarks->feature_density = density_.value();
  auto belief = std::make_shared<Belief>(
      *(options_.camera.wheels
            ? builder_.build(frame_, fusion_.at(stamp), mapper_.map().snapshot(), landmarks)
            : builder_.build(frame_, mapper_.map().snapshot(), landmarks)));
  if (frame_.state != Localization::kLost) memory_.add(*belief->landmarks);
  belief->landmarks = memory_.with_remembered(*belief->landmarks);
  belief->pose.position.z() = height_;
  belief->stamps.map = map_stamp_;
  belief->stamps.ranges = depth_stamp_;
  return belief;
}

CameraPicture CameraSensors::picture() const { return {pair_.left, odometry_.sightings()}; }

}  // namespace prospect
