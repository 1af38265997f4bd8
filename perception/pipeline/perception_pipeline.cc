// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/perception_pipeline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "engine/maps/pose_error.h"
#include "models/body_transform.h"
#include "models/knobs.h"
#include "models/parameter_check.h"
#include "models/reason.h"
#include "models/robot_description.h"
#include "perception/mapping/moving_surface.h"
#include "perception/mapping/pose_check.h"
#include "perception/odometry/body_pose.h"
#include "perception/odometry/lattice_cell.h"
#include "perception/odometry/median.h"
#include "perception/pipeline/depth_agreement.h"

namespace prospect {
namespace {

WheelFusionOptions fusion_of(const PerceptionOptions& options) {
  WheelFusionOptions fusion = options.wheel_fusion;
  fusion.start = options.start;
  return fusion;
}

ScanMapperOptions scans_of(const PerceptionOptions& options) {
  ScanMapperOptions scans = options.scan_mapping;
  scans.map = mapping_of(options);
  return scans;
}

DepthMapperOptions depths_of(const PerceptionOptions& options, const DepthCameraOnBody& camera) {
  DepthMapperOptions depths = options.depth_mapping;
  depths.map = mapping_of(options);
  if (camera.range) {
    depths.range = *camera.range;
    depths.map.max_range = std::min(depths.map.max_range, camera.range->max);
  }
  return depths;
}

/// By its covariance in the plane.
Localization state_of(const Eigen::Matrix4d& P, const PerceptionOptions& options) {
  if (!is_pose_covariance(P)) return Localization::kLost;
  const double mean = 0.5 * (P(0, 0) + P(1, 1));
  const double position = mean + std::hypot(0.5 * (P(0, 0) - P(1, 1)), P(0, 1));
  constexpr double kAhead = 1.0;  // [m]
  const double sigma = std::sqrt(position + kAhead * kAhead * P(3, 3));
  return sigma > options.pose_lost       ? Localization::kLost
         : sigma > options.pose_degraded ? Localization::kDegraded
                                         : Localization::kOk;
}

std::size_t finite_rays(const DepthScan& scan) {
  const auto finite = [](const std::vector<Eigen::Vector3d>& points) {
    return std::count_if(points.begin(), points.end(),
                         [](const Eigen::Vector3d& p) { return p.allFinite(); });
  };
  return scan.origin.allFinite() ? static_cast<std::size_t>(finite(scan.hits) + finite(scan.misses))
                                 : 0;
}

std::unique_ptr<Odometry> not_null(std::unique_ptr<Odometry> odometry) {
  if (!odometry) throw std::invalid_argument("perception: expected an odometry, got none");
  return odometry;
}

void check(const PerceptionOptions& o) {
  constexpr std::string_view kOwner = "perception";
  check_parameter(o.start.position.allFinite() && std::isfinite(o.start.yaw), kOwner, "start",
                  o.start.yaw, "a finite pose");
  check_parameter(!o.start_in_space || is_pose(*o.start_in_space), kOwner, "start_in_space",
                  o.start_in_space ? o.start_in_space->matrix().sum() : 0.0,
                  "a rotation and translation, finite");
  check_parameter(!o.wheels || !o.start_in_space, kOwner, "wheels", o.wheels,
                  "off with start_in_space: they measure motion in the plane");
  check_knobs(kOwner, o);
}

}  // namespace

std::string_view to_string(MapState state) {
  switch (state) {
    case MapState::kMapped:
      return "mapped";
    case MapState::kNoneYet:
      return "nothing is mapped yet: no depth image or scan could be entered";
    case MapState::kNoSource:
      break;
  }
  return "nothing is mapped: a stereo pair gives points, no surfaces; expected depth images or "
         "scans";
}

Eigen::Isometry3d PerceptionPipeline::start_pose(const PerceptionOptions& options) {
  return options.start_in_space.value_or(body_transform(options.start)) * options.stereo_mount.T_BC;
}

PerceptionPipeline::PerceptionPipeline(const StereoCamera& camera, const PerceptionOptions& options)
    : PerceptionPipeline(
          std::make_unique<StereoOdometry>(camera, options.odometry, start_pose(options)), camera,
          options) {}

PerceptionPipeline::PerceptionPipeline(std::unique_ptr<Odometry> odometry,
                                       const StereoCamera& camera, const PerceptionOptions& options)
    : PerceptionPipeline(not_null(std::move(odometry)), std::optional(camera), options) {}

PerceptionPipeline::PerceptionPipeline(const PerceptionOptions& options)
    : PerceptionPipeline(nullptr, std::nullopt, options) {}

PerceptionPipeline::PerceptionPipeline(std::unique_ptr<Odometry> odometry,
                                       const std::optional<StereoCamera>& camera,
                                       const PerceptionOptions& options)
    : options_(options),
      camera_(camera),
      odometry_(std::move(odometry)),
      motion_noise_(options.stereo_mount.T_BC),
      reader_(options.stereo_mount.T_BC),
      fusion_(fusion_of(options)),
      inertial_(options.inertial),
      map_(std::make_shared<OccupancyMapper>(mapping_of(options))),
      movers_(std::make_shared<MoverTracker>(options.movers)),
      builder_(options.stereo_mount.T_BC),
      density_(options.feature_density),
      log_(options.max_age, options.max_leap),
      history_(options.max_age),
      pose_at_fix_(options.start) {
  check(options);
  if (camera) validate(*camera);
  const bool measured_here = (odometry_ || options.wheels) && !options.start_in_space;
  if (options.loops && (measured_here || options.poses_drift) && StraightMap::is_built_in()) {
    straight_ = std::make_unique<StraightMap>(
        map_, options.start_in_space ? body_pose(*options.start_in_space) : options.start);
  }
  const ScanMapper checked(scans_of(options), map_);  // says what is wrong with them now
  if (options.depth_camera) options_.more_depth_cameras.emplace(0, *options.depth_camera);
  for (const auto& [sensor, on_body] : options_.more_depth_cameras) {
    validate(on_body.mount);
    mappers_.emplace(
        std::piecewise_construct, std::forward_as_tuple(sensor),
        std::forward_as_tuple(on_body.camera, depths_of(options, on_body), map_, movers_));
  }
  frame_.T_WC = start_pose(options);
}

InputResult PerceptionPipeline::stereo(const StampedPair& pair) {
  const double stamp = pair.left_stamp;
  if (!odometry_) {
    return log_.note(
        InputSource::kStereo,
        {InputState::kRefused, options_.wheels ? "there is no odometry: wheels tell poses"
                                               : "there is no odometry: poses come from outside"});
  }
  if (const auto objection = log_.objection(InputSource::kStereo, stamp)) return *objection;
  const double apart = std::abs(pair.right_stamp - stamp);
  if (!(apart <= options_.same_time)) {
    char text[96];
    std::snprintf(text, sizeof text, "left and right image are %.4f s apart; expected at most %g s",
                  apart, options_.same_time);
    return log_.note(InputSource::kStereo, {InputState::kRefused, text});
  }
  std::optional<Eigen::Isometry3d> by_wheels;
  if (options_.wheels) by_wheels = reader_.camera_motion(pose_at_fix_, fusion_.at(stamp).pose);
  frame_ = odometry_->process(stamp, pair.left, pair.right, where_to_look(stamp, by_wheels));
  lost_since_entry_ = lost_since_entry_ || frame_.state == Localization::kLost;
  const bool measured = frame_.tracked > 0 && frame_.state != Localization::kLost;
  motion_noise_.add(frame_, *odometry_);
  if (measured) hold_against_imu(by_wheels);
  log_.note(InputSource::kStereo, {});
  compare();
  const std::string why = disagreement();
  if (!why.empty()) {
    frame_.state = Localization::kLost;
    add_reason(frame_.reason, why);
  }
  fusion_.add(reader_.read(frame_));
  if (measured) pose_at_fix_ = fusion_.at(stamp).pose;
  if (frame_.keyframe) count_landmarks();
  const MotionInView in_C = odometry_->motion_in_view();
  motion_.reset();
  BodyPose now = body(stamp);
  if (!in_C.moving.empty()) {
    now.motion = motion_ =
        std::make_shared<const MotionInView>(now.T_WB * options_.stereo_mount.T_BC * in_C);
  }
  history_.add(stamp, now);
  enter_waiting();
  return {InputState::kTaken, frame_.reason};
}

InputResult PerceptionPipeline::wheels(const WheelSample& sample) {
  if (!options_.wheels) {
    return log_.note(InputSource::kWheels,
                     {InputState::kRefused, "the options say that there are no wheels"});
  }
  if (const auto objection = log_.objection(InputSource::kWheels, sample.stamp)) return *objection;
  if (!fusion_.add(sample)) {
    return log_.note(InputSource::kWheels, {InputState::kRefused, fusion_.at(sample.stamp).reason});
  }
  log_.note(InputSource::kWheels, {});
  newest_wheels_ = sample.stamp;
  if (!odometry_) history_.add(sample.stamp, body(sample.stamp));
  enter_waiting();
  return {};
}

InputResult PerceptionPipeline::imu(const ImuSample& sample) {
  if (const auto objection = log_.objection(InputSource::kImu, sample.stamp)) return *objection;
  if (!odometry_) {
    return log_.note(InputSource::kImu,
                     {InputState::kTaken, "there is no odometry that it could be held against"});
  }
  std::string wrong = inertial_.add(sample);
  if (wrong.empty()) wrong = inertial_.complaint();
  if (!wrong.empty()) {
    return log_.note(InputSource::kImu, {InputState::kRefused, std::move(wrong)});
  }
  return log_.note(InputSource::kImu, {});
}

std::optional<Eigen::Isometry3d> PerceptionPipeline::where_to_look(
    double stamp, const std::optional<Eigen::Isometry3d>& by_wheels) {
  const std::optional<Eigen::Isometry3d> by_imu = inertial_.expected(stamp);
  if (!by_imu) return by_wheels;
  const Eigen::Isometry3d& T_BC = options_.stereo_mount.T_BC;
  if (!by_wheels) {
    odometry_->expect(T_BC.inverse() * *by_imu * T_BC);
    return std::nullopt;
  }
  Eigen::Isometry3d T_B0B = T_BC * *by_wheels * T_BC.inverse();
  T_B0B.linear() = by_imu->linear();
  return T_BC.inverse() * T_B0B * T_BC;
}

void PerceptionPipeline::hold_against_imu(const std::optional<Eigen::Isometry3d>& by_wheels) {
  const bool begins_map = frame_.restarted || !std::exchange(begun_, true);
  if (log_.count(InputSource::kImu).taken == 0) return;
  const Eigen::Isometry3d& T_BC = options_.stereo_mount.T_BC;
  SeenMotion seen{
      .stamp = frame_.stamp, .T_WB = frame_.T_WC * T_BC.inverse(), .begins_map = begins_map};
  const Eigen::Matrix<double, 6, 6> since =
      odometry_->covariance_since(1).value_or(frame_.covariance_since_keyframe);
  seen.covariance = T_BC.linear() * since.bottomRightCorner<3, 3>() * T_BC.linear().transpose();
  const bool heard = log_.count(InputSource::kWheels).taken > 0 &&
                     frame_.stamp - newest_wheels_ <= options_.wheel_fusion.max_wheel_gap;
  if (by_wheels && heard) seen.by_wheels = T_BC * *by_wheels * T_BC.inverse();
  const InertialWitness::Judgement judgement = inertial_.judge(seen);
  if (judgement.verdict == InertialWitness::Verdict::kDisagrees) {
    frame_.state = std::max(frame_.state, Localization::kDegraded);
    add_reason(frame_.reason, judgement.reason);
  }
  const Eigen::Isometry3d T_CW = frame_.T_WC.inverse();
  frame_.covariance += inertial_.doubt(T_CW);
  frame_.covariance_since_keyframe += inertial_.doubt_since(imu_doubt_at_keyframe_, T_CW);
  if (frame_.keyframe) imu_doubt_at_keyframe_ = inertial_.sum();
}

InputResult PerceptionPipeline::external_pose(const ExternalPose& pose) {
  if (odometry_ || options_.wheels) {
    return log_.note(InputSource::kPose,
                     {InputState::kRefused,
                      odometry_ ? "the odometry gives the poses" : "the wheels give the poses"});
  }
  if (const auto objection = log_.objection(InputSource::kPose, pose.stamp)) return *objection;
  if (!is_pose(pose.T_WB)) {
    return log_.note(InputSource::kPose,
                     {InputState::kRefused, "the pose is no rotation and translation"});
  }
  if (external_ && pose.corrections != corrections_followed_) {
    if (std::string wrong = take_correction(pose); !wrong.empty()) {
      return log_.note(InputSource::kPose, {InputState::kRefused, std::move(wrong)});
    }
  }
  corrections_followed_ = pose.corrections;
  log_.note(InputSource::kPose, {});
  if (external_ && pose.jumps.count != external_->jumps.count) {
    history_ = PoseHistory(options_.max_age);
    builder_.restart();
  }
  external_ = pose;
  if (const MapFrame* map = corrections_.frame().get(); map && !options_.poses_drift) {
    const Eigen::Isometry3d T_WM = body_transform(map->map_in_W());
    external_->T_WB = T_WM * pose.T_WB;
    Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
    R.topLeftCorner<3, 3>() = T_WM.linear();
    external_->covariance = R * pose.covariance * R.transpose();
  }
  external_->state = std::max(pose.state, state_of(pose.covariance, options_));
  Eigen::Matrix4d& covariance = external_->covariance;
  if (!options_.start_in_space) {  // it stands on the floor, whatever the pose says of z
    covariance.row(2).setZero();
    covariance.col(2).setZero();
  }
  const double jumped = pose.jumps.distance * pose.jumps.distance;
  covariance.diagonal() += Eigen::Vector4d(jumped, jumped, 0.0, pose.jumps.turn * pose.jumps.turn);
  history_.add(pose.stamp, body(pose.stamp));
  enter_waiting();
  return {};
}

std::string PerceptionPipeline::take_correction(const ExternalPose& pose) {
  if (!external_->T_OB || !pose.T_OB || !is_pose(*external_->T_OB) || !is_pose(*pose.T_OB)) {
    return "the pose was corrected, and nobody says how the robot went on meanwhile";
  }
  const Eigen::Isometry3d T_WB = external_->T_WB * external_->T_OB->inverse() * *pose.T_OB;
  Correction correction;
  correction.stamp = pose.stamp;
  correction.T_new_old =
      pose.T_WB * T_WB.inverse() * body_transform(origin_of(corrections_.frame().get())).inverse();
  correction.covariance = pose.covariance;
  correction.why = "the pose from outside jumped, the odometry did not";
  return corrections_.take(correction, body_pose(T_WB)).why;
}

InputResult PerceptionPipeline::correct(const Correction& correction) {
  const Pose now = pose(known_until().value_or(frame_.stamp));
  const Corrections::Answer answer =
      prospect::correct(correction, robot(now), corrections_, straight_.get());
  if (answer.verdict == CorrectionVerdict::kTaken) return {};
  return {InputState::kRefused, answer.why};
}

InputResult PerceptionPipeline::depth(double stamp, DepthImage image, int sensor) {
  if (!mappers_.contains(sensor)) {
    return log_.note(InputSource::kDepth,
                     {InputState::kRefused, "the options say that there is no depth camera"});
  }
  if (const auto objection = log_.objection(InputSource::kDepth, stamp, sensor)) return *objection;
  const auto shared = std::make_shared<const DepthImage>(std::move(image));
  if (sensor == 0) {
    depth_ = shared;
    compare();
  }
  return take({stamp, shared, {}, sensor});
}

InputResult PerceptionPipeline::scan(double stamp, DepthScan in_B, int sensor) {
  if (sensor < 0 || sensor >= kMostDepthSensors) {
    return log_.note(
        InputSource::kScan,
        {InputState::kRefused, "of sensor " + std::to_string(sensor) + "; expected 0 to " +
                                   std::to_string(kMostDepthSensors - 1)});
  }
  if (const auto objection = log_.objection(InputSource::kScan, stamp, sensor)) return *objection;
  if (finite_rays(in_B) == 0) {
    return log_.note(InputSource::kScan, {InputState::kRefused, "no ray is finite"}, false, sensor);
  }
  return take({stamp, nullptr, std::move(in_B), sensor});
}

InputSource PerceptionPipeline::source_of(const Waiting& input) {
  return input.depth ? InputSource::kDepth : InputSource::kScan;
}

bool PerceptionPipeline::ahead(double stamp) const {
  const std::optional<double> known = known_until();
  return known && stamp > *known + options_.max_ahead;
}

InputResult PerceptionPipeline::take(Waiting input) {
  const InputSource source = source_of(input);
  const int sensor = input.sensor;
  if (!ahead(input.stamp)) return log_.note(source, enter(input), false, sensor);
  const InputResult waits =
      log_.note(source, {InputState::kWaiting, "its pose is not known yet"}, false, sensor);
  const auto later = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const Waiting& w) { return w.stamp > input.stamp; });
  waiting_.insert(later, std::move(input));
  while (static_cast<int>(waiting_.size()) > options_.most_waiting) {
    log_.note(source_of(waiting_.front()),
              {InputState::kLate, "no pose of its time came while it waited"}, true,
              waiting_.front().sensor);
    waiting_.pop_front();
  }
  return waits;
}

void PerceptionPipeline::enter_waiting() {
  while (!waiting_.empty() && !ahead(waiting_.front().stamp)) {
    const Waiting input = std::move(waiting_.front());
    waiting_.pop_front();
    log_.note(source_of(input), enter(input), true, input.sensor);
  }
}

MappedFrame PerceptionPipeline::enter_depth(const Waiting& input, const BodyPose& body) {
  const CameraMount& mount = options_.more_depth_cameras.at(input.sensor).mount;
  return mappers_.at(input.sensor)
      .process(input.stamp, *input.depth, body.T_WB * mount.T_BC, body.state, body.motion.get());
}

MappedFrame PerceptionPipeline::enter_scan(const Waiting& input, const BodyPose& body) {
  // S stands at the rays' origin, with the axes of B.
  const Eigen::Vector3d& origin = input.scan.origin;
  DepthScan scan_S = input.scan;
  scan_S.origin.setZero();
  for (Eigen::Vector3d& p : scan_S.hits) p -= origin;
  for (Eigen::Vector3d& p : scan_S.misses) p -= origin;
  return scan_mappers_.try_emplace(input.sensor, scans_of(options_), map_, movers_)
      .first->second.process(input.stamp, scan_S, body.T_WB * Eigen::Translation3d(origin),
                             body.state);
}

InputResult PerceptionPipeline::enter(const Waiting& input) {
  const std::optional<BodyPose> body = body_at(input.stamp);
  if (!body) return {InputState::kLate, "the pose of its time is not known any more"};
  mapped_ = input.depth ? enter_depth(input, *body) : enter_scan(input, *body);
  if (mapped_.state == Mapping::kRejected) {
    // Held back for its pose alone, it says that mapping goes on: a guard that took the map for
    // stale would keep a lost robot from turning until it is found.
    const char* const held_back = not_mapped_at(body->state);
    if (map_stamp_ && held_back != nullptr && mapped_.reason.ends_with(held_back)) {
      map_stamp_ = std::max(*map_stamp_, input.stamp);
    }
    return {InputState::kRefused, mapped_.reason};
  }
  map_stamp_ = std::max(map_stamp_.value_or(input.stamp), input.stamp);
  keep_straight(input.stamp, body->pose);
  std::string reason = mapped_.reason;
  if (!input.depth) {
    const std::size_t rays = input.scan.hits.size() + input.scan.misses.size();
    const std::size_t sound = finite_rays(input.scan);
    if (sound < rays) {
      add_reason(reason, std::to_string(rays - sound) + " of " + std::to_string(rays) +
                             " rays are not finite: left out");
    }
  }
  return {InputState::kTaken, reason};
}

StraightMap::Robot PerceptionPipeline::robot(const Pose& pose) const {
  const Eigen::Vector3i planar(0, 1, 3);
  if (options_.poses_drift) {
    return {pose, external_ ? Eigen::Matrix3d(external_->covariance(planar, planar))
                            : Eigen::Matrix3d::Zero()};
  }
  return {pose, options_.wheels
                    ? fusion_.at(known_until().value_or(frame_.stamp)).covariance
                    : Eigen::Matrix3d(body_covariance(frame_.T_WC, options_.stereo_mount.T_BC,
                                                      frame_.covariance)(planar, planar))};
}

void PerceptionPipeline::keep_straight(double stamp, const Pose& pose) {
  if (!straight_) return;
  // What was drawn before a loss and what is drawn after it may lie apart.
  const StraightMap::Robot here = robot(pose);
  if (std::exchange(lost_since_entry_, false)) straight_->begin_anchor(here);
  if (const auto done = go_on(*straight_, stamp, here, corrections_)) {
    memory_.follow(*done->correction.moves);
  }
}

bool PerceptionPipeline::give_map(bool place_known) {
  if (!straight_) return place_known;
  straight_->give(robot(pose(known_until().value_or(frame_.stamp))), place_known);
  return true;
}

bool PerceptionPipeline::lift() {
  if (!straight_) return false;
  straight_->lift(robot(pose(known_until().value_or(frame_.stamp))));
  return true;
}

void PerceptionPipeline::finish() {
  if (straight_) straight_->finish(known_until().value_or(0.0));
}

std::optional<double> PerceptionPipeline::known_until() const {
  std::optional<double> known = history_.newest();
  if (log_.count(InputSource::kWheels).taken > 0) {
    known = std::max(known.value_or(newest_wheels_), newest_wheels_);
  }
  return known;
}

BodyPose PerceptionPipeline::body(double stamp) const {
  BodyPose body;
  if (options_.wheels) {
    const FusedOdometry fused = fusion_.at(stamp);
    if (!odometry_) {
      body = by_wheels(fused);
    } else {
      body.pose = fused.pose;
      body.state = std::max(frame_.state, fused.state);
    }
  } else if (odometry_) {
    body.T_WB = frame_.T_WC * options_.stereo_mount.T_BC.inverse();
    body.state = frame_.state;
  } else if (external_) {
    body.T_WB = external_->T_WB;
    body.state = external_->state;
  } else {
    body.T_WB = options_.start_in_space.value_or(body_transform(options_.start));
    body.state = Localization::kLost;
  }
  body.motion = motion_;
  if (!options_.wheels) body.pose = body_pose(body.T_WB);
  if (!options_.start_in_space) {
    body.pose.position.z() = options_.start.position.z();
    body.T_WB = body_transform(body.pose);
  }
  return body;
}

BodyPose PerceptionPipeline::by_wheels(const FusedOdometry& fused) const {
  BodyPose body;
  body.pose = fused.pose;
  const bool heard = log_.count(InputSource::kWheels).taken > 0 &&
                     fused.stamp - fused.newest <= options_.wheel_fusion.max_wheel_gap;
  body.state = heard ? Localization::kOk : Localization::kLost;
  return body;
}

std::optional<BodyPose> PerceptionPipeline::body_at(double stamp) const {
  const std::optional<double> newest = history_.newest();
  std::optional<BodyPose> body;
  if (newest && stamp < *newest) {
    body = history_.at(stamp);
    if (body && !options_.start_in_space) body->T_WB = body_transform(body->pose);
  } else {
    body = this->body(stamp);
    // Where it starts is known.
    if (!known_until()) body->state = Localization::kOk;
  }
  return body;
}

void PerceptionPipeline::compare() {
  const InputCount& depths = log_.count(InputSource::kDepth);
  if (!depth_ || log_.count(InputSource::kStereo).taken == 0 ||
      !(std::abs(*depths.newest - frame_.stamp) <= options_.same_time)) {
    return;
  }
  std::unordered_set<std::uint64_t> tracked;
  for (const LandmarkSighting& s : odometry_->sightings()) {
    if (s.tracked) tracked.insert(s.id);
  }
  const Eigen::Isometry3d T_CW = frame_.T_WC.inverse();
  std::vector<Eigen::Vector3d> points;
  std::vector<double> far;  // how far away they are [m]
  const std::shared_ptr<const LandmarkMap> landmarks = odometry_->landmarks(0.0);
  for (const Landmark& l : landmarks->landmarks) {
    if (tracked.count(l.id) == 0) continue;
    points.push_back(T_CW * l.position);
    far.push_back(points.back().z());
  }
  if (points.empty()) return;
  const DepthCameraOnBody& camera = *options_.depth_camera;
  DepthAgreementOptions agreement;
  agreement.range = options_.depth_mapping.range;
  // Both are errors of the disparity, so their share grows with the depth.
  const double by_zero = frame_.disparity_offset_sigma / (camera_->left.fx * camera_->baseline);
  const double by_time = frame_.camera_time_offset_depth / std::max(0.1, median(far));
  const ScaleAgreement found =
      depth_agreement(points, std::hypot(by_zero, by_time), camera.camera,
                      options_.stereo_mount.T_BC.inverse() * camera.mount.T_BC, *depth_, agreement);
  if (found.verdict != ScaleAgreement::Verdict::kUnknown) agreement_ = found;
}

std::string PerceptionPipeline::disagreement() const {
  if (agreement_.verdict != ScaleAgreement::Verdict::kDisagree) return {};
  return to_string(agreement_, "depths by the stereo pair are", "those of the depth camera") +
         "; expected the same: the baseline or focal length of the pair, or the depth camera's "
         "unit, is wrong";
}

std::string PerceptionPipeline::complaint() const {
  const std::string depths = disagreement();
  if (!depths.empty() || !options_.wheels) return depths;
  const FusedOdometry fused = fusion_.at(frame_.stamp);
  return fused.agreement.verdict == ScaleAgreement::Verdict::kDisagree ? fused.reason : "";
}

void PerceptionPipeline::count_landmarks() {
  // What an image cell shows 2 m away: on an edge corners are found anew in every view.
  constexpr double kPlace = 0.15;  // [m]
  int anew = 0;
  const std::shared_ptr<const LandmarkMap> landmarks = odometry_->landmarks(0.0);
  for (const Landmark& l : landmarks->landmarks) {
    anew += places_.insert(lattice_cell(l.position, kPlace)).second;
  }
  const double r = options_.mapping.resolution;
  density_.add(anew, static_cast<double>(map().surface_voxels()) * r * r);
}

MapState PerceptionPipeline::map_state() const {
  if (map_stamp_) return MapState::kMapped;
  const bool source = !mappers_.empty() || log_.count(InputSource::kScan).newest;
  return source ? MapState::kNoneYet : MapState::kNoSource;
}

std::shared_ptr<const Belief> PerceptionPipeline::belief(double stamp) {
  Belief belief;
  if (odometry_) {
    LandmarkMap landmarks = *odometry_->landmarks(0.0);
    landmarks.feature_density = density_.value();
    landmarks.odometry_noise = motion_noise_.noise();
    belief = options_.wheels
                 ? builder_.build(frame_, fusion_.at(stamp), map().snapshot(), std::move(landmarks))
                 : builder_.build(frame_, map().snapshot(), std::move(landmarks));
    if (frame_.state != Localization::kLost) memory_.add(*belief.landmarks);
    belief.landmarks = memory_.with_remembered(*belief.landmarks);
  } else if (options_.wheels) {
    const FusedOdometry fused = fusion_.at(stamp);
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
    const Eigen::Vector3i planar(0, 1, 3);
    covariance(planar, planar) = fused.covariance;
    belief = builder_.build(fused.newest, by_wheels(fused), covariance, map().snapshot());
    belief.stamp = fused.stamp;
    belief.twist = fused.twist;
  } else {
    const ExternalPose none{.stamp = stamp, .state = Localization::kLost};
    const ExternalPose& newest = external_ ? *external_ : none;
    belief = builder_.build(newest.stamp, body(stamp), newest.covariance, map().snapshot());
  }
  if (!options_.start_in_space) belief.pose.position.z() = options_.start.position.z();
  belief.movers = movers_->movers(belief.stamp);
  belief.map_frame = corrections_.frame();
  if (straight_) {
    const Eigen::Vector3i planar(0, 1, 3);
    belief.covariance(planar, planar) =
        straight_->covariance({belief.pose, belief.covariance(planar, planar)});
  }
  belief.stamps.map = map_stamp_.value_or(0.0);
  const std::optional<double> depth = log_.count(InputSource::kDepth).newest,
                              scan = log_.count(InputSource::kScan).newest;
  if (depth || scan) {
    constexpr double kNever = -std::numeric_limits<double>::infinity();
    belief.stamps.ranges = std::max(depth.value_or(kNever), scan.value_or(kNever));
    if (const auto more = log_.oldest_of_more()) {
      belief.stamps.ranges = std::min(belief.stamps.ranges, *more);
    }
  }
  return std::make_shared<const Belief>(std::move(belief));
}

std::shared_ptr<const Belief> PerceptionPipeline::belief() {
  return belief(known_until().value_or(frame_.stamp));
}

}  // namespace prospect
