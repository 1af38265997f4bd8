// SPDX-License-Identifier: Apache-2.0
#include "engine/features/footprint_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace prospect {
namespace {

// P_fov P_range is cut off at e to the minus this.
constexpr double kNegligibleExponent = 12.0;
// Of sides; what single precision takes without that scores are off by more than they may be.
constexpr double kSteepest = 6.0;

void check(bool ok, const char* what, double value, const char* expected) {
  if (!ok) {
    throw std::invalid_argument("footprint visibility: " + std::string(what) + " is " +
                                std::to_string(value) + "; expected " + expected);
  }
}

/// What a pair of opposite sides asks of a point at the angle a from the axis: the exponents of its
/// two sigmoids are (sine cos a +- cosine sin a) / angle_scale - inset - bias.
struct Sides {
  double sine, cosine, bias;
};

/// Of half a field of view, which is `closed` where the sides meet.
Sides sides_of(double half, double closed, double angle_scale) {
  constexpr double kNoSide = -1e3;  // an exponent that is 1 whatever the rest
  if (half >= closed - angle_scale) return {0.0, 0.0, kNoSide};
  if (half > 0.5 * std::numbers::pi) {
    const double slope = std::min(1.0 / std::sin(half), kSteepest);
    return {slope, 0.0, slope * std::cos(half) / angle_scale};
  }
  half = std::max(half, angle_scale);
  const double slope = std::max(1.0, kSteepest * angle_scale / std::sin(half));
  return {slope * std::sin(half), slope * std::cos(half), 0.0};
}

}  // namespace

FootprintVisibility::Scratch::Scratch(int points) {
  const Eigen::Index n = FootprintKernel::padded(points);
  for (Eigen::ArrayXd* a : {&probability, &d_x, &d_y, &d_z, &X, &Y, &Z, &u, &u_x, &u_y, &u_z, &q,
                            &q_x, &q_y, &q_z, &q_yaw}) {
    a->setZero(n);
  }
  for (Eigen::ArrayXf* a : {&score_probability, &score_X, &score_Y, &score_Z, &score_u, &score_q}) {
    a->setZero(n);
  }
  point.setZero(n);
}

FootprintVisibility::FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount,
                                         std::shared_ptr<const OcclusionTable> occlusion,
                                         const Options& options)
    : footprint_(footprint), mount_(mount), options_(options), occlusion_(std::move(occlusion)) {
  if (!occlusion_) throw std::invalid_argument("footprint visibility: no occlusion table given");
  prepare();
}

FootprintVisibility::FootprintVisibility(const RgbdFootprint& footprint, const CameraMount& mount)
    : footprint_(footprint), mount_(mount) {
  prepare();
}

void FootprintVisibility::prepare() {
  const RgbdFootprint& f = footprint_;
  validate(f);
  check(options_.angle_scale > 0.0, "angle_scale", options_.angle_scale, "> 0 rad");
  check(options_.range_scale > 0.0, "range_scale", options_.range_scale, "> 0 m");
  check(options_.inset >= 0.0, "inset", options_.inset, ">= 0");
  const std::vector<Eigen::Vector3d> none;
  const std::vector<Eigen::Vector3d>& points = occlusion_ ? occlusion_->points() : none;
  const auto n = static_cast<Eigen::Index>(points.size());
  for (Eigen::ArrayXd* p : {&px_, &py_, &pz_}) p->setZero(capacity());
  for (Eigen::Index c = 0; c < n; ++c) {
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(c)];
    px_[c] = p.x();
    py_[c] = p.y();
    pz_[c] = p.z();
  }
  if (n > 0) score_origin_ = points.front();
  score_px_ = (px_ - score_origin_.x()).cast<float>();
  score_py_ = (py_ - score_origin_.y()).cast<float>();
  score_pz_ = (pz_ - score_origin_.z()).cast<float>();
  FootprintKernelConstants& k = constants_;
  const Sides horizontal = sides_of(0.5 * f.horizontal_fov, std::numbers::pi, options_.angle_scale);
  const Sides vertical =
      sides_of(0.5 * f.vertical_fov, 0.5 * std::numbers::pi, options_.angle_scale);
  k.sin_h = horizontal.sine;
  k.cos_h = horizontal.cosine;
  k.bias_h = horizontal.bias;
  k.sin_v = vertical.sine;
  k.cos_v = vertical.cosine;
  k.bias_v = vertical.bias;
  k.inset = options_.inset;
  k.inverse_angle_scale = 1.0 / options_.angle_scale;
  k.inverse_range_scale = 1.0 / options_.range_scale;
  k.min_range = f.min_range;
  k.max_range = f.max_range;
  k.negligible = std::exp(-kNegligibleExponent);
  // One sigmoid alone is below e^-12 from this many scales outside its edge.
  const double scales = std::max(0.0, kNegligibleExponent - options_.inset);
  const double beside = std::max(0.0, kNegligibleExponent - options_.inset - k.bias_h);
  k.outside_squared = std::pow(beside * options_.angle_scale, 2);
  k.far_squared = std::pow(f.max_range + scales * options_.range_scale, 2);
}

FootprintKernelPose FootprintVisibility::kernel_pose(const Pose& pose) const {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  Eigen::Matrix3d R_WB;
  R_WB << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Vector3d arm = R_WB * mount_.T_BC.translation();
  FootprintKernelPose p;
  Eigen::Vector3d::Map(p.sensor) = pose.position + arm;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p.R) =
      (R_WB * mount_.T_BC.linear()).transpose();
  p.arm[0] = arm.x();
  p.arm[1] = arm.y();
  return p;
}

double FootprintVisibility::in_footprint(const Pose& pose, const Eigen::Vector3d& point) const {
  const FootprintKernelPose p = kernel_pose(pose);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R_CW(p.R);
  const Eigen::Vector3d Y = R_CW * (point - Eigen::Vector3d::Map(p.sensor));
  if (!Y.allFinite()) return 0.0;
  return footprint_value(constants_, Y.x(), Y.y(), Y.z());
}

int FootprintVisibility::score(FootprintKernelPose p, Scratch& s, const Views& views) const {
  auto sensor = Eigen::Vector3d::Map(p.sensor);
  occlusion_->score(sensor, s.score_probability.data());
  sensor -= score_origin_;
  const int n = kernel_.select_score(
      constants_, p,
      {score_px_.data(), score_py_.data(), score_pz_.data(), s.score_probability.data(), size()},
      {views.point, s.score_X.data(), s.score_Y.data(), s.score_Z.data()});
  for (int j = 0; j < FootprintKernel::padded(n); ++j) {
    s.score_u[j] = s.score_probability[views.point[j]];
  }
  kernel_.value_score(constants_,
                      {s.score_X.data(), s.score_Y.data(), s.score_Z.data(), s.score_u.data(), n},
                      s.score_q.data());
  for (int j = 0; j < n; ++j) views.q[j] = static_cast<double>(s.score_q[j]);
  return n;
}

int FootprintVisibility::view(const Pose& pose, Scratch& s, const Views& views) const {
  const FootprintKernelPose p = kernel_pose(pose);
  const auto sensor = Eigen::Vector3d::Map(p.sensor);
  if (!sensor.allFinite() || !std::isfinite(pose.yaw)) return -1;
  if (views.score) return score(p, s, views);
  const bool gradient = views.d_x != nullptr;
  if (gradient) {
    occlusion_->evaluate(sensor, s.probability.data(), s.d_x.data(), s.d_y.data(), s.d_z.data());
  } else {
    occlusion_->evaluate(sensor, s.probability.data());
  }
  const int n = kernel_.select(constants_, p,
                               {px_.data(), py_.data(), pz_.data(), s.probability.data(), size()},
                               {views.point, s.X.data(), s.Y.data(), s.Z.data()});
  const int padded = FootprintKernel::padded(n);
  for (int j = 0; j < padded; ++j) s.u[j] = s.probability[views.point[j]];
  const FootprintKernel::Points selected{s.X.data(), s.Y.data(), s.Z.data(), s.u.data(), n};
  if (!gradient) {
    kernel_.value(constants_, selected, views.q);
    return n;
  }
  for (int j = 0; j < padded; ++j) {
    const int c = views.point[j];
    s.u_x[j] = s.d_x[c];
    s.u_y[j] = s.d_y[c];
    s.u_z[j] = s.d_z[c];
  }
  kernel_.gradient(constants_, p, selected, {s.u_x.data(), s.u_y.data(), s.u_z.data()},
                   {views.q, views.d_x, views.d_y, views.d_z, views.d_yaw});
  return n;
}

void FootprintVisibility::evaluate(const Pose& pose, Scratch& s, double* q) const {
  Views views;
  views.point = s.point.data();
  views.q = s.q.data();
  const int n = view(pose, s, views);
  Eigen::Map<Eigen::ArrayXd> out(q, size());
  out.setConstant(n < 0 ? std::numeric_limits<double>::quiet_NaN() : 0.0);
  for (int j = 0; j < n; ++j) q[s.point[j]] = s.q[j];
}

Eigen::Vector4d FootprintVisibility::gradient(const Pose& pose, const double* weight,
                                              Scratch& s) const {
  const int n =
      view(pose, s,
           {s.point.data(), s.q.data(), s.q_x.data(), s.q_y.data(), s.q_z.data(), s.q_yaw.data()});
  if (n < 0) return Eigen::Vector4d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (int j = 0; j < n; ++j) {
    sum += weight[s.point[j]] * Eigen::Vector4d(s.q_x[j], s.q_y[j], s.q_z[j], s.q_yaw[j]);
  }
  return sum;
}

}  // namespace prospect
