// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/odometry_calibration.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/problem/trajectory.h"
#include "models/multirotor.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

/// Sigma_rel at the end of a path of levelled poses, by the recursion of the prediction.
Matrix4d relative_covariance(const VisibilityPrediction& prediction, const std::vector<Pose>& path,
                             const double* prior_count = nullptr) {
  static const Multirotor model;  // the motion model whose pose has all of x, y, z and yaw
  TrajectoryBatch trajectory;
  trajectory.horizon = {&model, static_cast<int>(path.size()) - 1, 1.0};
  trajectory.layout = model.pose_layout();
  const int nx = model.nx();
  trajectory.states = BatchArray::Zero(static_cast<Eigen::Index>(path.size()) * nx, 1);
  for (std::size_t k = 0; k < path.size(); ++k) {
    trajectory.states.block(static_cast<Eigen::Index>(k) * nx, 0, nx, 1) =
        model.state(path[k], Twist{}).array();
  }
  return prediction.relative_covariances(trajectory, 0, prior_count).back();
}

/// L, levelled, to a camera that looks along its x axis.
Isometry3d level_mount() { return CameraMount::forward_facing(Vector3d::Zero()); }

/// The path in L of its first pose.
std::vector<Pose> levelled(const std::vector<Isometry3d>& path) {
  if (path.size() < 2) {
    throw std::invalid_argument("visibility forecast: a path of " + std::to_string(path.size()) +
                                " poses; expected two at least");
  }
  std::vector<Pose> poses;
  for (const Isometry3d& T_WC : path) {
    const Eigen::Vector4d motion = level_motion(path.front().inverse() * T_WC);
    double yaw = motion[3];
    if (!poses.empty()) yaw = poses.back().yaw + std::remainder(yaw - poses.back().yaw, 2.0 * M_PI);
    poses.push_back({motion.head<3>(), yaw});
  }
  return poses;
}

/// It looks ahead in L. What one image shows counts, whether or not the other one shows it, too.
VisibilityPrediction level_prediction(const std::vector<Landmark>& landmarks, StereoCamera camera,
                                      const VisibilityParameters& parameters) {
  camera.baseline = 0.0;
  return {landmarks, camera, CameraMount{level_mount()}, nullptr, parameters};
}

VisibilityAgreement agreement(int horizon, const std::vector<double>& expected,
                              const std::vector<double>& counted,
                              const std::vector<double>& probability,
                              const std::vector<char>& tracked) {
  return {horizon, count_agreement(expected, counted), reliability(probability, tracked)};
}

}  // namespace

VisibilityParameters odometry_visibility(const StereoCamera& camera,
                                         const StereoOdometryOptions& options) {
  VisibilityParameters p;
  p.sigma_px = options.pose.sigma_left;
  // A patch of 15 x 15 px with the pixel around it that gradients need, and what it may move. The
  // planner's own border is as soft as its gradient needs it; a tracker's is hard.
  p.border_px = 9.5;
  p.border_sigma_px = 1.0;
  const double focal_baseline = camera.left.fx * camera.baseline;
  p.r_min = focal_baseline / (options.matching.max_disparity * camera.left.width);
  p.r_min_width = 0.1 * p.r_min;
  // A point that was made at the farthest depth can still be tracked from twice as far.
  p.r_max = 2.0 * focal_baseline / options.matching.min_disparity;
  p.r_max_width = 0.1 * p.r_max;
  // The tracker's limit is in the size of the image of a patch. While the camera goes forward,
  // points move outwards, and the range shrinks less than the depth does.
  p.scale_min = 1.05 / options.max_scale;
  p.scale_max = options.max_scale;
  p.scale_width = 0.035;
  return p;
}

Eigen::Vector4d level_motion(const Isometry3d& T_C0C1) {
  const Matrix3d R_LC = CameraMount::forward_facing(Vector3d::Zero()).linear();
  const Vector3d ahead = R_LC * T_C0C1.linear().col(2);
  Eigen::Vector4d motion;
  motion << R_LC * T_C0C1.translation(), std::atan2(ahead.y(), ahead.x());
  return motion;
}

VisibilityForecast forecast_visibility(const std::vector<Landmark>& landmarks,
                                       const StereoCamera& camera,
                                       const std::vector<Isometry3d>& path,
                                       const VisibilityParameters& parameters) {
  // A frame L in which the first camera is level and looks along x: the planner's prediction turns
  // about the z axis.
  const Matrix3d R_LC = CameraMount::forward_facing(Vector3d::Zero()).linear();
  const Matrix3d R_LW = R_LC * path.front().linear().transpose();
  const Vector3d origin = path.front().translation();
  std::vector<Landmark> levelled_landmarks = landmarks;
  for (Landmark& l : levelled_landmarks) {
    l.position = R_LW * (l.position - origin);
    l.creation_direction = R_LW * l.creation_direction;
    l.covariance = R_LW * l.covariance * R_LW.transpose();
  }
  const std::vector<Pose> poses = levelled(path);
  const VisibilityPrediction level = level_prediction(levelled_landmarks, camera, parameters);
  const Matrix4d sigma = relative_covariance(level, poses);
  // What is left of the last orientation besides its heading goes into the mount.
  const Pose& end = poses.back();
  CameraMount mount;
  mount.T_BC.setIdentity();
  mount.T_BC.linear() = Eigen::AngleAxisd(-end.yaw, Vector3d::UnitZ()).toRotationMatrix() * R_LW *
                        path.back().linear();
  StereoCamera one = camera;
  one.baseline = 0.0;
  return {VisibilityPrediction(levelled_landmarks, one, mount, nullptr, parameters)
              .probabilities(end, sigma),
          sigma};
}

Matrix4d forecast_motion(const StereoCamera& camera, const std::vector<Isometry3d>& path,
                         const VisibilityParameters& parameters,
                         const std::vector<double>& tracked) {
  if (tracked.size() != path.size()) {
    throw std::invalid_argument("motion forecast: " + std::to_string(tracked.size()) +
                                " counts for " + std::to_string(path.size()) +
                                " poses; expected one each");
  }
  return relative_covariance(level_prediction({}, camera, parameters), levelled(path),
                             tracked.data());
}

OdometryCalibration::OdometryCalibration(const StereoCamera& camera,
                                         const StereoOdometryOptions& odometry_options,
                                         const OdometryCalibrationOptions& options)
    : camera_(camera),
      parameters_(odometry_visibility(camera, odometry_options)),
      options_(options),
      noise_(level_mount()),
      scores_(options.horizons.size()) {
  if (options.stride < 1) {
    throw std::invalid_argument("odometry calibration: stride is " +
                                std::to_string(options.stride) + "; expected 1 at least");
  }
  for (const int horizon : options.horizons) {
    if (horizon < 1) {
      throw std::invalid_argument("odometry calibration: a horizon is " + std::to_string(horizon) +
                                  " frames; expected 1 at least");
    }
    longest_ = std::max(longest_, horizon);
  }
}

void OdometryCalibration::add(const StereoOdometry& odometry, const OdometryFrame& frame,
                              const std::optional<Isometry3d>& true_T_WC) {
  const int now = frames_++;
  estimates_.push_back(frame.T_WC);
  truths_.push_back(true_T_WC);
  lost_.push_back(frame.state == Localization::kLost);
  tracked_.push_back(frame.tracked);
  while (static_cast<int>(estimates_.size()) > longest_ + 1) {
    estimates_.pop_front();
    truths_.pop_front();
    lost_.pop_front();
    tracked_.pop_front();
  }
  consistency_.add(odometry, frame, true_T_WC);
  noise_.add(frame, odometry);
  std::unordered_set<std::uint64_t> tracked;
  for (const LandmarkSighting& sighting : odometry.sightings()) {
    if (sighting.tracked) tracked.insert(sighting.id);
  }
  for (const Origin& origin : origins_) {
    for (std::size_t h = 0; h < scores_.size(); ++h) {
      if (origin.frame + options_.horizons[h] == now) compare(origin, h, tracked);
    }
  }
  while (!origins_.empty() && origins_.front().frame + longest_ <= now) origins_.pop_front();
  // A landmark that is given up now was tracked now, and is not known about from the next frame on.
  for (Origin& origin : origins_) {
    origin.given_up.insert(odometry.given_up().begin(), odometry.given_up().end());
  }
  if (now % options_.stride == 0 && frame.state != Localization::kLost) {
    // The first frame does not tell what the next ones will be apart: as most recordings.
    const double period = now > 0 ? frame.stamp - last_stamp_ : 0.1;
    Origin origin{now, {}, noise_.noise().value_or(parameters_.odometry), {}};
    for (const int horizon : options_.horizons) {
      origin.maps.push_back(odometry.landmarks(horizon * period));
    }
    origins_.push_back(std::move(origin));
  }
  last_stamp_ = frame.stamp;
}

void OdometryCalibration::compare(const Origin& origin, std::size_t h,
                                  const std::unordered_set<std::uint64_t>& tracked) {
  const std::size_t steps = static_cast<std::size_t>(options_.horizons[h]);
  const std::size_t from = estimates_.size() - 1 - steps;
  bool known = true;
  for (std::size_t k = from; k < truths_.size(); ++k) known = known && truths_[k].has_value();
  std::vector<Isometry3d> path;
  for (std::size_t k = from; k < estimates_.size(); ++k) {
    path.push_back(known ? estimates_[from] * truths_[from]->inverse() * *truths_[k]
                         : estimates_[k]);
  }
  std::vector<Landmark> landmarks = origin.maps[h]->landmarks;
  std::erase_if(landmarks, [&](const Landmark& l) { return origin.given_up.contains(l.id); });
  given_up_ += static_cast<int>(origin.maps[h]->landmarks.size() - landmarks.size());
  if (landmarks.empty()) return;
  VisibilityParameters measured = parameters_;
  measured.odometry = origin.noise;
  const Eigen::VectorXd online =
      forecast_visibility(landmarks, camera_, path, measured).probability;
  for (Landmark& l : landmarks) l.survival = options_.constant_survival;
  const Eigen::VectorXd constant =
      forecast_visibility(landmarks, camera_, path, parameters_).probability;
  Scores& s = scores_[h];
  if (known && !lost_.back()) {
    Eigen::Vector4d error = level_motion(estimates_[from].inverse() * estimates_.back()) -
                            level_motion(truths_[from]->inverse() * *truths_.back());
    error[3] = std::remainder(error[3], 2.0 * M_PI);
    const std::vector<double> counts(tracked_.end() - static_cast<std::ptrdiff_t>(path.size()),
                                     tracked_.end());
    const auto nees = [&](const VisibilityParameters& parameters) {
      return normalised_error_squared(error, forecast_motion(camera_, path, parameters, counts));
    };
    s.motion.push_back(nees(measured));
    s.motion_assumed.push_back(nees(parameters_));
  }
  double count = 0.0;
  for (Eigen::Index i = 0; i < online.size(); ++i) {
    const bool seen = tracked.contains(landmarks[static_cast<std::size_t>(i)].id);
    count += seen;
    s.probability.push_back(online[i]);
    s.probability_constant.push_back(constant[i]);
    s.tracked.push_back(seen);
  }
  s.expected_count.push_back(online.sum());
  s.expected_count_constant.push_back(constant.sum());
  s.count.push_back(count);
}

void OdometryCalibration::begin_recording() {
  frames_ = 0;
  origins_.clear();
  estimates_.clear();
  truths_.clear();
  lost_.clear();
  tracked_.clear();
  consistency_.begin_recording();
  noise_ = MotionNoise(level_mount());
}

OdometryCalibrationResult OdometryCalibration::result() const {
  OdometryCalibrationResult result;
  for (std::size_t h = 0; h < scores_.size(); ++h) {
    const Scores& s = scores_[h];
    const int horizon = options_.horizons[h];
    result.online.push_back(
        agreement(horizon, s.expected_count, s.count, s.probability, s.tracked));
    result.constant.push_back(
        agreement(horizon, s.expected_count_constant, s.count, s.probability_constant, s.tracked));
    result.motion.push_back(pose_consistency(s.motion, 4));
    result.motion_assumed.push_back(pose_consistency(s.motion_assumed, 4));
    result.predictions += static_cast<int>(s.tracked.size());
  }
  result.consistency = consistency_.result();
  result.given_up = given_up_;
  return result;
}

}  // namespace prospect
