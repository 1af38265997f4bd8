// SPDX-License-Identifier: Apache-2.0
#include "engine/features/visibility_prediction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/features/occlusion_table.h"
#include "engine/maps/usable_landmarks.h"
#include "models/knobs.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

namespace vd = visibility_derivative;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr const char* kOwner = "visibility prediction";
constexpr double kSmallestNearDepth = 0.1;  // [m]; gate, see the header
constexpr double kSmoothing = 1e-3;         // e of the smooth length [m] and angle [rad]
constexpr double kLargest = 1e8;  // poses beyond are not evaluable [m], [rad]; nor landmarks

// sqrt(x^2 + e^2) - e and its derivative over x.
double smooth_length(double squared, double& derivative_over_x) {
  const double root = std::sqrt(squared + kSmoothing * kSmoothing);
  derivative_over_x = 1.0 / root;
  // Without cancellation for x << e.
  return squared / (root + kSmoothing);
}

void check(const VisibilityParameters& p, const StereoCamera& camera) {
  check_knobs(kOwner, p);
  check_knobs("visibility prediction: odometry", p.odometry);
  check_positive(kOwner, "camera fx", camera.left.fx);
  check_positive(kOwner, "camera fy", camera.left.fy);
  check_not_negative(kOwner, "camera baseline", camera.baseline);
  check_parameter(camera.left.width > 2.0 * p.border_px && std::isfinite(camera.left.width), kOwner,
                  "camera width", camera.left.width, "more than twice border_px");
  check_parameter(camera.left.height > 2.0 * p.border_px && std::isfinite(camera.left.height),
                  kOwner, "camera height", camera.left.height, "more than twice border_px");
}

[[noreturn]] void refuse(const Landmark& landmark, const std::string& what) {
  throw std::invalid_argument(std::string(kOwner) + ": landmark " + std::to_string(landmark.id) +
                              ": " + what);
}

void check(const Landmark& l) {
  if (const std::string fault = fault_of(l, kLargest); !fault.empty()) refuse(l, fault);
}

/// l in lane j, its position from `origin`.
template <typename T>
void set_lane(VisibilityBlockOf<T>& block, int j, const Landmark& l, const Vector3d& origin) {
  const auto put = [j](T* lanes, double x) { lanes[j] = static_cast<T>(x); };
  put(block.x, l.position.x() - origin.x());
  put(block.y, l.position.y() - origin.y());
  put(block.z, l.position.z() - origin.z());
  const Matrix3d S = 0.5 * (l.covariance + l.covariance.transpose());
  put(block.xx, S(0, 0));
  put(block.xy, S(0, 1));
  put(block.xz, S(0, 2));
  put(block.yy, S(1, 1));
  put(block.yz, S(1, 2));
  put(block.zz, S(2, 2));
  const Vector3d n = l.creation_direction.normalized();
  put(block.nx, n.x());
  put(block.ny, n.y());
  put(block.nz, n.z());
  put(block.inverse_creation_range, 1.0 / std::max(l.creation_range, 1e-6));
  put(block.survival, l.survival);
  put(block.multiplicity, l.multiplicity);
  put(block.per_cell, l.per_cell);
}

/// Whole blocks of landmarks. Padding stands where the last one does, so that it does not keep a
/// block from being skipped.
template <typename T>
std::vector<VisibilityBlockOf<T>> make_blocks(const std::vector<Landmark>& landmarks,
                                              const Vector3d& origin) {
  constexpr std::size_t kLanes = VisibilityBlockOf<T>::kLanes;
  std::vector<VisibilityBlockOf<T>> blocks((landmarks.size() + kLanes - 1) / kLanes);
  Landmark padding;
  padding.survival = 0.0;
  if (!landmarks.empty()) padding.position = landmarks.back().position;
  for (std::size_t i = 0; i < blocks.size() * kLanes; ++i) {
    set_lane(blocks[i / kLanes], static_cast<int>(i % kLanes),
             i < landmarks.size() ? landmarks[i] : padding, origin);
  }
  return blocks;
}

bool evaluable(const Pose& pose) {
  return std::abs(pose.position.x()) < kLargest && std::abs(pose.position.y()) < kLargest &&
         std::abs(pose.position.z()) < kLargest && std::abs(pose.yaw) < kLargest;
}

}  // namespace

class VisibilityPrediction::Scratch : public TermScratch {
 public:
  Scratch(std::size_t num_blocks, std::size_t num_score_blocks, int stages) {
    const std::size_t n = num_blocks * VisibilityBlock::kLanes;
    probability.assign(n, 1.0);
    d_x.assign(n, 0.0);
    d_y.assign(n, 0.0);
    d_z.assign(n, 0.0);
    score_probability.assign(num_score_blocks * VisibilityScoreBlock::kLanes, 1.0f);
    results.resize(num_blocks);
    score_results.resize(num_score_blocks);
    const std::size_t m = static_cast<std::size_t>(stages);
    for (auto* v : {&out.count, &out.variance, &out.log_det, &out.count_adjoint,
                    &out.variance_adjoint, &out.log_det_adjoint, &out.prior_adjoint}) {
      v->assign(m, 0.0);
    }
    inputs.resize(m);
    sums.resize(m);
    d_log_det.resize(m);
    sigma.assign(m, Matrix4d::Zero());
    poses.resize(m);
  }

  std::vector<double> probability, d_x, d_y, d_z;  // P_unoccluded at the stage in work
  std::vector<float> score_probability;            // the same for a score
  std::vector<VisibilityBlockResult> results;      // of the stage in work
  std::vector<VisibilityScoreResult> score_results;
  std::vector<VisibilityKernelStage> inputs;
  std::vector<VisibilitySums> sums;
  std::vector<std::array<double, vd::kCount>> d_log_det;
  std::vector<Matrix4d, Eigen::aligned_allocator<Matrix4d>> sigma;
  std::vector<Pose> poses;
  Request request;
  Stages out;
};

VisibilityPrediction::Stages& VisibilityPrediction::stages(TermScratch& scratch) {
  return static_cast<Scratch&>(scratch).out;
}

VisibilityParameters with_redetected_landmarks(VisibilityParameters parameters) {
  parameters.scale_min = 0.0;
  parameters.scale_max = 1e3;
  parameters.view_angle = 1.4;
  return parameters;
}

VisibilityPrediction::VisibilityPrediction(const std::vector<Landmark>& landmarks,
                                           const StereoCamera& camera, const CameraMount& mount,
                                           std::shared_ptr<const OcclusionTable> occlusion,
                                           const VisibilityParameters& parameters,
                                           const VisibilityKernel& kernel)
    : num_landmarks_(static_cast<int>(landmarks.size())),
      camera_(camera),
      mount_(mount),
      occlusion_(std::move(occlusion)),
      parameters_(parameters),
      kernel_(kernel) {
  check(parameters, camera);
  if (!mount.T_BC.matrix().allFinite()) {
    throw std::invalid_argument(std::string(kOwner) + ": camera mount is not finite");
  }
  if (occlusion_ && occlusion_->num_points() != num_landmarks_) {
    throw std::invalid_argument(std::string(kOwner) + ": the occlusion table has " +
                                std::to_string(occlusion_->num_points()) + " points; expected " +
                                std::to_string(num_landmarks_) + ", one per landmark");
  }
  for (std::size_t i = 0; occlusion_ && i < landmarks.size(); ++i) {
    if (occlusion_->points()[i] != landmarks[i].position) {
      refuse(landmarks[i], "is not point " + std::to_string(i) +
                               " of the occlusion table; expected the same points in one order");
    }
  }

  for (const Landmark& l : landmarks) check(l);
  blocks_ = make_blocks<double>(landmarks, Vector3d::Zero());
  if (!landmarks.empty()) score_origin_ = landmarks.front().position;
  score_blocks_ = make_blocks<float>(landmarks, score_origin_);

  VisibilityKernelConstants& c = constants_;
  c.fx = camera.left.fx;
  c.fy = camera.left.fy;
  c.fx_baseline = camera.left.fx * camera.baseline;
  c.u_min = parameters.border_px - camera.left.cx;
  c.u_max = camera.left.width - parameters.border_px - camera.left.cx;
  c.v_min = parameters.border_px - camera.left.cy;
  c.v_max = camera.left.height - parameters.border_px - camera.left.cy;
  c.pixel_variance = parameters.sigma_px * parameters.sigma_px;
  c.border_variance = parameters.border_sigma_px * parameters.border_sigma_px;
  c.near_depth = std::max(kSmallestNearDepth, c.fx_baseline / (c.u_max - c.u_min));
  c.r_min = parameters.r_min;
  c.r_max = parameters.r_max;
  c.inverse_r_min_width = 1.0 / parameters.r_min_width;
  c.inverse_r_max_width = 1.0 / parameters.r_max_width;
  c.scale_min = parameters.scale_min;
  c.scale_max = parameters.scale_max;
  c.inverse_scale_width = 1.0 / parameters.scale_width;
  c.cos_view = std::cos(parameters.view_angle);
  // The width in the cosine that has the given width in the angle at the limit.
  c.inverse_cos_width = 1.0 / (std::sin(parameters.view_angle) * parameters.view_angle_width);
  const Matrix3d R_CB = mount.T_BC.linear().transpose();
  const Vector3d t = mount.T_BC.translation();
  Vector3d::Map(c.up) = R_CB.col(2);
  Vector3d::Map(c.lever) = R_CB * Vector3d(t.y(), -t.x(), 0.0);
}

Eigen::Vector3d VisibilityPrediction::sensor_position(const Pose& pose) const {
  const Vector3d t = mount_.T_BC.translation();
  const double cy = std::cos(pose.yaw), sy = std::sin(pose.yaw);
  return pose.position + Vector3d(cy * t.x() - sy * t.y(), sy * t.x() + cy * t.y(), t.z());
}

Matrix4d VisibilityPrediction::with_scale(const Matrix4d& sigma, const Vector3d& d) const {
  const double scale = parameters_.odometry.scale;
  if (!(scale > 0.0)) return sigma;
  Matrix4d sum = sigma;
  sum.topLeftCorner<3, 3>() += scale * scale * d * d.transpose();
  return sum;
}

VisibilityKernelStage VisibilityPrediction::stage_inputs(const Pose& pose,
                                                         const Matrix4d& sigma) const {
  VisibilityKernelStage s;
  Vector3d::Map(s.sensor) = sensor_position(pose);
  const double cy = std::cos(pose.yaw), sy = std::sin(pose.yaw);
  Matrix3d R_BW;
  R_BW << cy, sy, 0.0, -sy, cy, 0.0, 0.0, 0.0, 1.0;
  const Matrix3d R = mount_.T_BC.linear().transpose() * R_BW;
  Eigen::Map<RowMatrix3d>(s.R) = R;
  const Matrix3d M = R * sigma.topLeftCorner<3, 3>() * R.transpose();
  s.M[0] = M(0, 0);
  s.M[1] = M(1, 1);
  s.M[2] = M(2, 2);
  s.M[3] = M(0, 1);
  s.M[4] = M(0, 2);
  s.M[5] = M(1, 2);
  Vector3d::Map(s.c) = -(R * sigma.topRightCorner<3, 1>());
  s.s = sigma(3, 3);
  return s;
}

void VisibilityPrediction::unoccluded(const Vector3d& sensor, bool gradient,
                                      Scratch& scratch) const {
  if (!occlusion_) return;
  if (gradient) {
    occlusion_->evaluate(sensor, scratch.probability.data(), scratch.d_x.data(), scratch.d_y.data(),
                         scratch.d_z.data());
  } else {
    occlusion_->evaluate(sensor, scratch.probability.data());
  }
}

void VisibilityPrediction::score(const VisibilityKernelStage& stage, Scratch& scratch,
                                 VisibilitySums& sums, double* information) const {
  const Vector3d sensor = Vector3d::Map(stage.sensor);
  if (occlusion_) occlusion_->score(sensor, scratch.score_probability.data());
  VisibilityKernelStage from_origin = stage;
  Vector3d::Map(from_origin.sensor) = sensor - score_origin_;
  kernel_.score(score_blocks_.data(), static_cast<int>(score_blocks_.size()), constants_,
                from_origin, scratch.score_probability.data(), scratch.score_results.data(), sums);
  if (information == nullptr) return;
  kernel_.score_information(blocks_.data(), static_cast<int>(blocks_.size()), constants_, stage,
                            scratch.score_results.data(), information);
}

std::unique_ptr<TermScratch> VisibilityPrediction::make_scratch(const Horizon& horizon) const {
  return std::make_unique<Scratch>(blocks_.size(), score_blocks_.size(), horizon.N + 1);
}

bool VisibilityPrediction::propagate(const TrajectoryBatch& t, int b, const Request& request,
                                     const double* prior_count, TermScratch& term_scratch) const {
  Scratch& scratch = static_cast<Scratch&>(term_scratch);
  const int N = t.horizon.N;
  const int num_blocks = static_cast<int>(blocks_.size());
  const OdometryNoise& noise = parameters_.odometry;
  const bool vertical = t.layout.pz >= 0;
  Stages& out = scratch.out;
  scratch.request = request;
  for (int k = 0; k <= N; ++k) {
    scratch.poses[static_cast<std::size_t>(k)] = t.pose(k, b);
    if (!evaluable(scratch.poses[static_cast<std::size_t>(k)])) return false;
  }
  UnoccludedInput open = {scratch.probability.data()};
  if (request.gradient) {
    open = {open.probability, scratch.d_x.data(), scratch.d_y.data(), scratch.d_z.data()};
  }
  scratch.sigma[0].setZero();
  for (int k = 0; k <= N; ++k) {
    const std::size_t n = static_cast<std::size_t>(k);
    const Pose& pose = scratch.poses[n];
    const Matrix4d& sigma = scratch.sigma[n];
    VisibilityKernelStage& stage = scratch.inputs[n];
    VisibilitySums& sums = scratch.sums[n];
    stage = stage_inputs(pose, with_scale(sigma, pose.position - scratch.poses[0].position));
    Matrix6d I;
    const bool scored = request.score && !request.gradient;
    if (scored) {
      score(stage, scratch, sums, request.information ? I.data() : nullptr);
    } else {
      unoccluded(Vector3d::Map(stage.sensor), request.gradient, scratch);
      kernel_.evaluate(blocks_.data(), num_blocks, constants_, stage, open, scratch.results.data(),
                       sums);
    }
    const double prior = prior_count ? prior_count[k] : 0.0;
    out.count[n] = sums.count + prior;
    out.variance[n] = sums.variance + prior;

    if (request.information) {
      if (!scored) {
        kernel_.information(blocks_.data(), num_blocks, constants_, stage, scratch.results.data(),
                            I.data());
      }
      I.diagonal().head<3>().array() += request.prior_translation;
      I.diagonal().tail<3>().array() += request.prior_rotation;
      const Eigen::LLT<Matrix6d> cholesky(I);
      if (cholesky.info() != Eigen::Success) return false;
      out.log_det[n] = 2.0 * Matrix6d(cholesky.matrixL()).diagonal().array().log().sum();
      if (request.gradient) {
        const Matrix6d inverse = cholesky.solve(Matrix6d::Identity());
        kernel_.information_gradient(blocks_.data(), num_blocks, constants_, stage,
                                     scratch.results.data(), inverse.data(),
                                     scratch.d_log_det[n].data());
      }
    }

    if (k == N) break;
    const Vector3d step = scratch.poses[n + 1].position - pose.position;
    const double turn = scratch.poses[n + 1].yaw - pose.yaw;
    double slope;
    const double s = smooth_length(step.squaredNorm(), slope);
    const double a = smooth_length(turn * turn, slope);
    const double inflation =
        (noise.reference_count + noise.floor_count) / (out.count[n] + noise.floor_count);
    const double w_p = inflation * (noise.position_per_metre * noise.position_per_metre * s +
                                    noise.position_per_radian * noise.position_per_radian * a);
    const double w_yaw = inflation * (noise.yaw_per_metre * noise.yaw_per_metre * s +
                                      noise.yaw_per_radian * noise.yaw_per_radian * a);
    Matrix4d F = Matrix4d::Identity();
    F(0, 3) = -step.y();
    F(1, 3) = step.x();
    Matrix4d next = F * sigma * F.transpose();
    next(0, 0) += w_p;
    next(1, 1) += w_p;
    if (vertical) next(2, 2) += w_p;
    next(3, 3) += w_yaw;
    scratch.sigma[n + 1] = next;
  }
  return true;
}

void VisibilityPrediction::pull_back(const TrajectoryBatch& t, int b, TermScratch& term_scratch,
                                     TermOutput& out) const {
  Scratch& scratch = static_cast<Scratch&>(term_scratch);
  const int N = t.horizon.N;
  const OdometryNoise& noise = parameters_.odometry;
  const bool vertical = t.layout.pz >= 0;
  Stages& stages = scratch.out;
  const double ppm2 = noise.position_per_metre * noise.position_per_metre;
  const double ppr2 = noise.position_per_radian * noise.position_per_radian;
  const double ypm2 = noise.yaw_per_metre * noise.yaw_per_metre;
  const double ypr2 = noise.yaw_per_radian * noise.yaw_per_radian;
  const double scale2 = noise.scale * noise.scale;
  Matrix3d turn_rate;  // dR_CW/dyaw = turn_rate R_CW: v -> v x up
  turn_rate << 0.0, constants_.up[2], -constants_.up[1], -constants_.up[2], 0.0, constants_.up[0],
      constants_.up[1], -constants_.up[0], 0.0;

  Matrix4d adjoint = Matrix4d::Zero();  // dJ/dSigma_rel,k+1, symmetric
  for (int k = N; k >= 0; --k) {
    const std::size_t n = static_cast<std::size_t>(k);
    const Pose& pose = scratch.poses[n];
    const Matrix4d& sigma = scratch.sigma[n];
    double d_count = stages.count_adjoint[n];

    if (k < N) {
      const Vector3d step = scratch.poses[n + 1].position - pose.position;
      const double turn = scratch.poses[n + 1].yaw - pose.yaw;
      double s_slope, a_slope;
      const double s = smooth_length(step.squaredNorm(), s_slope);
      const double a = smooth_length(turn * turn, a_slope);
      const double inflation =
          (noise.reference_count + noise.floor_count) / (stages.count[n] + noise.floor_count);
      const double w_p = adjoint(0, 0) + adjoint(1, 1) + (vertical ? adjoint(2, 2) : 0.0);
      const double w_yaw = adjoint(3, 3);
      d_count -= inflation / (stages.count[n] + noise.floor_count) *
                 ((ppm2 * s + ppr2 * a) * w_p + (ypm2 * s + ypr2 * a) * w_yaw);
      Vector3d d_step = inflation * (ppm2 * w_p + ypm2 * w_yaw) * s_slope * step;
      const double d_turn = inflation * (ppr2 * w_p + ypr2 * w_yaw) * a_slope * turn;
      Matrix4d F = Matrix4d::Identity();
      F(0, 3) = -step.y();
      F(1, 3) = step.x();
      const Matrix4d d_F = 2.0 * adjoint * F * sigma;
      d_step.x() += d_F(1, 3);
      d_step.y() -= d_F(0, 3);
      out.add_pose_gradient(t, k + 1, b, d_step.x(), d_step.y(), d_step.z(), d_turn);
      out.add_pose_gradient(t, k, b, -d_step.x(), -d_step.y(), -d_step.z(), -d_turn);
      adjoint = (F.transpose() * adjoint * F).eval();
    }

    // The cost through what is seen at stage k.
    const double d_variance = scratch.request.variance ? stages.variance_adjoint[n] : 0.0;
    const double d_log_det = scratch.request.information ? stages.log_det_adjoint[n] : 0.0;
    stages.prior_adjoint[n] = d_count + d_variance;
    std::array<double, vd::kCount> d;
    for (int m = 0; m < vd::kCount; ++m) {
      const std::size_t i = static_cast<std::size_t>(m);
      d[i] = d_count * scratch.sums[n].d_count[m] + d_variance * scratch.sums[n].d_variance[m];
      if (scratch.request.information) d[i] += d_log_det * scratch.d_log_det[n][i];
    }
    const VisibilityKernelStage& stage = scratch.inputs[n];
    const Matrix3d R = Eigen::Map<const RowMatrix3d>(stage.R);
    const Vector3d d_Y = Vector3d::Map(d.data() + vd::kCamera);
    const Vector3d d_sensor = Vector3d::Map(d.data() + vd::kSensor);
    const Vector3d d_position = d_sensor - R.transpose() * d_Y;
    const Vector3d lever = Vector3d::Map(stage.sensor) - pose.position;
    double d_yaw = d[vd::kYaw] + d_sensor.y() * lever.x() - d_sensor.x() * lever.y();

    Matrix3d M, d_M;
    M << stage.M[0], stage.M[3], stage.M[4], stage.M[3], stage.M[1], stage.M[5], stage.M[4],
        stage.M[5], stage.M[2];
    const double* m = d.data() + vd::kM;
    d_M << m[0], 0.5 * m[3], 0.5 * m[4], 0.5 * m[3], m[1], 0.5 * m[5], 0.5 * m[4], 0.5 * m[5], m[2];
    const Vector3d c = Vector3d::Map(stage.c);
    const Vector3d d_c = Vector3d::Map(d.data() + vd::kC);
    d_yaw += 2.0 * d_M.cwiseProduct(turn_rate * M).sum() + d_c.dot(turn_rate * c);
    out.add_pose_gradient(t, k, b, d_position.x(), d_position.y(), d_position.z(), d_yaw);

    const Matrix3d d_position_covariance = R.transpose() * d_M * R;
    if (scale2 > 0.0) {
      const Vector3d d =
          2.0 * scale2 * (d_position_covariance * (pose.position - scratch.poses[0].position));
      out.add_pose_gradient(t, k, b, d.x(), d.y(), d.z(), 0.0);
      out.add_pose_gradient(t, 0, b, -d.x(), -d.y(), -d.z(), 0.0);
    }
    adjoint.topLeftCorner<3, 3>() += d_position_covariance;
    const Vector3d cross = -0.5 * (R.transpose() * d_c);
    adjoint.topRightCorner<3, 1>() += cross;
    adjoint.bottomLeftCorner<1, 3>() += cross.transpose();
    adjoint(3, 3) += d[vd::kS];
  }
}

Eigen::VectorXd VisibilityPrediction::probabilities(const Pose& pose,
                                                    const Matrix4d& sigma_rel) const {
  Eigen::VectorXd pi =
      Eigen::VectorXd::Constant(num_landmarks_, std::numeric_limits<double>::quiet_NaN());
  if (!evaluable(pose) || !sigma_rel.allFinite()) return pi;
  Scratch scratch(blocks_.size(), score_blocks_.size(), 1);
  const VisibilityKernelStage stage = stage_inputs(pose, sigma_rel);
  unoccluded(Vector3d::Map(stage.sensor), false, scratch);
  kernel_.evaluate(blocks_.data(), static_cast<int>(blocks_.size()), constants_, stage,
                   {scratch.probability.data()}, scratch.results.data(), scratch.sums[0]);
  for (int i = 0; i < num_landmarks_; ++i) {
    pi[i] = scratch.results[static_cast<std::size_t>(i / VisibilityBlock::kLanes)]
                .pi[i % VisibilityBlock::kLanes];
  }
  return pi;
}

std::vector<double> VisibilityPrediction::visible(const TrajectoryBatch& t, int b) const {
  const auto scratch = make_scratch(t.horizon);
  if (!propagate(t, b, Request{}, nullptr, *scratch)) {
    return std::vector<double>(static_cast<std::size_t>(t.horizon.N + 1),
                               std::numeric_limits<double>::quiet_NaN());
  }
  return stages(*scratch).count;
}

std::vector<Matrix4d> VisibilityPrediction::relative_covariances(const TrajectoryBatch& t, int b,
                                                                 const double* prior_count) const {
  const auto scratch = make_scratch(t.horizon);
  const bool ok = propagate(t, b, Request{}, prior_count, *scratch);
  const auto& stored = static_cast<const Scratch&>(*scratch).sigma;
  std::vector<Matrix4d> sigma(stored.begin(), stored.end());
  for (std::size_t k = 0; k < sigma.size(); ++k) {
    sigma[k] =
        with_scale(sigma[k], t.pose(static_cast<int>(k), b).position - t.pose(0, b).position);
  }
  if (!ok) {
    for (Matrix4d& s : sigma) s.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return sigma;
}

void describe(Knobs& knobs, VisibilityParameters& p) {
  knobs.number("sigma_px", p.sigma_px, {0.01, 50.0}, "px", "noise of an image point");
  knobs.number("border_px", p.border_px, {0.0, 1e4}, "px",
               "strip along the image border where nothing can be tracked");
  knobs.number("border_sigma_px", p.border_sigma_px, {0.0, 1e4}, "px", "softness of that border");
  knobs.number("r_min", p.r_min, {0.001, 100.0}, "m", "nearest useful depth");
  knobs.number("r_max", p.r_max, {0.5, 1000.0}, "m", "farthest useful depth");
  knobs.require(p.r_max > p.r_min, "r_max", "r_max <= r_min; expected more");
  knobs.number("r_min_width", p.r_min_width, {1e-4, 100.0}, "m", "softness of the nearest");
  knobs.number("r_max_width", p.r_max_width, {1e-4, 100.0}, "m", "softness of the farthest");
  knobs.number("scale_min", p.scale_min, {0.0, 1e3}, "1",
               "range over that at which a landmark was made, at which its tracking is lost");
  knobs.number("scale_max", p.scale_max, {0.001, 1e6}, "1", "the same, farther off");
  knobs.require(p.scale_max > p.scale_min, "scale_max", "scale_max <= scale_min; expected more");
  knobs.number("scale_width", p.scale_width, {1e-4, 100.0}, "1", "softness of both");
  knobs.number("view_angle", p.view_angle, {0.01, 3.14}, "rad",
               "largest angle to the direction from which a landmark was made");
  knobs.number("view_angle_width", p.view_angle_width, {1e-4, 3.14}, "rad", "softness of it");
}

}  // namespace prospect
