// SPDX-License-Identifier: Apache-2.0
#include "perception/fusion/inertial_witness.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/knobs.h"
#include "perception/odometry/se3.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kKept = 10.0;     // [s] of samples
constexpr double kWindow = 1.0;    // [s] over which a slow turn is to show
constexpr double kFollowed = 5.0;  // [s] for which something may be followed
constexpr double kLikely = 0.5;    // [s] for which a velocity is likely to go on by itself
constexpr int kProven = 5;         // turns
// A pose that was just found, by itself.
constexpr double kVisionTurn = 0.002, kVisionWay = 0.003, kVisionShare = 0.02;
constexpr double kTellingTurn = 4.0;  // deviations from which on a turn tells something
constexpr double kRestWalk = 0.02;    // [m/s^2 per sqrt(s)] of c: W's tilt, warming up
constexpr double kUnknownRest = 2.0;  // [m/s^2] of c before it was measured
constexpr double kWheelTurn = 0.02, kWheelShare = 0.1;  // [rad], of the turn

Vector3d rotation_vector(const Quaterniond& q) {
  const Eigen::AngleAxisd turn(q.normalized());
  const double angle = std::remainder(turn.angle(), 2.0 * M_PI);
  return angle * turn.axis();
}

Vector3d in_degrees(const Vector3d& v) { return v / kRadiansPerDegree; }

}  // namespace

InertialWitness::InertialWitness(const InertialOptions& options)
    : options_(options), samples_(kKept, options.max_gap) {
  check_knobs("inertial", options);
  bias_variance_.setConstant(options.gyro_bias * options.gyro_bias);
}

double InertialWitness::position_sigma(const Vector3d& way) const {
  return kVisionWay + kVisionShare * way.norm();
}

std::optional<InertialWitness::Way> InertialWitness::way_of(const ImuMotion& motion,
                                                            const Frame& from) const {
  if (!velocity_) return std::nullopt;
  const double dt = motion.dt;
  Way way;
  // What an accelerometer is wrong by grows with the square of the time.
  if (motion.has_force && rest_variance_ > 0.0 && dt <= kWindow) {
    const double a = options_.acceleration * options_.acceleration + rest_variance_;
    way.way = *velocity_ * dt + from.T_WB.linear() * motion.way - 0.5 * rest_force_ * dt * dt;
    way.variance = velocity_variance_ * dt * dt + 0.25 * a * std::pow(dt, 4);
  } else {
    way.way = *velocity_ * std::min(dt, kLikely);
    way.variance = 0.0;  // not measured
  }
  return way;
}

std::optional<Isometry3d> InertialWitness::expected(double stamp) const {
  if (!believed_ || differed_ > 0 || frames_.empty()) return std::nullopt;
  const Frame& from = frames_.back();
  const std::optional<ImuMotion> motion = samples_.between(from.stamp, stamp, bias_);
  if (!motion) return std::nullopt;
  Isometry3d T = Isometry3d::Identity();
  T.linear() = motion->R_B0B.toRotationMatrix();
  if (const auto way = way_of(*motion, from)) {
    T.translation() = from.T_WB.linear().transpose() * way->way;
  }
  return T;
}

std::optional<InertialWitness::Turn> InertialWitness::turn_since(const Frame& from,
                                                                 const SeenMotion& seen) const {
  const std::optional<ImuMotion> motion = samples_.between(from.stamp, seen.stamp, bias_);
  if (!motion) return std::nullopt;
  Turn turn;
  const Quaterniond by_vision(Matrix3d(from.T_WB.linear().transpose() * seen.T_WB.linear()));
  turn.error = rotation_vector(motion->R_B0B.conjugate() * by_vision);
  // Either may be the one that turns.
  turn.seen = rotation_vector(by_vision).norm();
  turn.angle = std::max(rotation_vector(motion->R_B0B).norm(), turn.seen);
  const double dt = motion->dt, share = options_.gyro_share * turn.angle,
               noise = options_.gyro_noise * dt;
  Matrix3d S = seen.covariance;
  S.diagonal() += bias_variance_ * dt * dt;
  S.diagonal().array() += noise * noise + share * share + kVisionTurn * kVisionTurn;
  turn.chi2 = turn.error.dot(S.ldlt().solve(turn.error));
  turn.sigma = std::sqrt(S.trace() / 3.0);
  return turn;
}

void InertialWitness::learn_bias(const Turn& turn, double dt, const Matrix3d& vision) {
  const double share = options_.gyro_share * turn.angle;
  for (int axis = 0; axis < 3; ++axis) {
    double& P = bias_variance_[axis];
    P += options_.bias_walk * options_.bias_walk * dt;
    const double noise =
        (share * share + kVisionTurn * kVisionTurn + vision(axis, axis)) / (dt * dt) +
        options_.gyro_noise * options_.gyro_noise;
    const double gain = P / (P + noise);
    bias_[axis] -= gain * turn.error[axis] / dt;
    P *= 1.0 - gain;
  }
}

void InertialWitness::take_velocity(const ImuMotion& motion, const Frame& from,
                                    const Vector3d& way) {
  const double dt = motion.dt, sigma = position_sigma(way);
  velocity_ = way / dt;
  velocity_variance_ = 2.0 * sigma * sigma / (dt * dt);
  if (!motion.has_force || !(rest_variance_ > 0.0)) return;
  const Matrix3d R = from.T_WB.linear();
  // From the mean over the time to its end.
  *velocity_ += R * (motion.velocity - motion.way / dt) - 0.5 * rest_force_ * dt;
  velocity_variance_ +=
      0.25 * (options_.acceleration * options_.acceleration + rest_variance_) * dt * dt;
}

void InertialWitness::learn_rest_force(const ImuMotion& motion, const Frame& from,
                                       const Vector3d& way) {
  const Matrix3d R = from.T_WB.linear();
  const double dt = motion.dt;
  const Vector3d s = R * motion.way, V = R * motion.velocity;
  if (!motion.has_force) {
    before_.reset();
    return;
  }
  if (!(rest_variance_ > 0.0)) {
    rest_force_ = V / dt;
    rest_variance_ = kUnknownRest * kUnknownRest;
  } else if (before_) {
    // From the way of two intervals: way' = ((way - s) / dt + V) dt' + s' - c (dt dt' + dt'^2) / 2.
    const Before& b = *before_;
    const double half = 0.5 * (b.dt * dt + dt * dt), sigma = position_sigma(way);
    const Vector3d measured = (((b.way - b.by_imu) / b.dt + b.velocity) * dt + s - way) / half;
    const double noise =
        6.0 * sigma * sigma / (half * half) + options_.acceleration * options_.acceleration;
    rest_variance_ += kRestWalk * kRestWalk * dt;
    const double gain = rest_variance_ / (rest_variance_ + noise);
    rest_force_ += gain * (measured - rest_force_);
    rest_variance_ *= 1.0 - gain;
  }
  before_ = Before{s, V, way, dt};
}

void InertialWitness::count(bool informative, Verdict verdict) {
  outvoted_ = verdict == Verdict::kOutvoted ? outvoted_ + 1 : 0;
  if (!informative) return;
  if (verdict == Verdict::kAgrees) {
    agreed_ = std::min(agreed_ + 1, kProven);
    differed_ = 0;
    if (agreed_ >= kProven) believed_ = true;
  } else {
    ++differed_;
    if (outvoted_ >= kProven || (agreed_ < kProven && differed_ >= kProven)) {
      believed_ = false;
      agreed_ = 0;
    }
    if (!believed_) agreed_ = 0;
  }
}

void InertialWitness::begin(const SeenMotion& seen) {
  frames_ = {{seen.stamp, seen.T_WB}};
  velocity_.reset();
  before_.reset();
  followed_.setZero();
}

InertialWitness::Judgement InertialWitness::judge(const SeenMotion& seen) {
  if (frames_.empty() || seen.begins_map || !(seen.stamp > frames_.back().stamp)) {
    begin(seen);
    return {};
  }
  const Frame from = frames_.back();
  const auto go_on = [&] {
    frames_.push_back({seen.stamp, seen.T_WB});
    while (frames_.size() > 1 && frames_.front().stamp < seen.stamp - kWindow) frames_.pop_front();
  };
  const std::optional<ImuMotion> motion = samples_.between(from.stamp, seen.stamp, bias_);
  const std::optional<Turn> turn = turn_since(from, seen);
  if (!motion || !turn) {
    begin(seen);
    return {};
  }
  const std::optional<Turn> longer =
      frames_.size() > 1 ? turn_since(frames_.front(), seen) : std::nullopt;
  const Vector3d way = seen.T_WB.translation() - from.T_WB.translation();
  const std::optional<Way> by_imu = way_of(*motion, from);
  const bool turns_otherwise =
      turn->chi2 > options_.gate || (longer && longer->chi2 > options_.gate);
  Vector3d missed = Vector3d::Zero();
  const bool goes_otherwise = jumped(by_imu, way, *motion, seen.stamp, missed);

  Judgement judgement;
  judgement.verdict = turns_otherwise || goes_otherwise ? Verdict::kDisagrees : Verdict::kAgrees;
  if (judgement.verdict == Verdict::kDisagrees && seen.by_wheels) {
    const Isometry3d vision = from.T_WB.inverse() * seen.T_WB;
    const Isometry3d off = seen.by_wheels->inverse() * vision;
    const double angle = rotation_vector(Quaterniond(off.linear())).norm();
    if (angle <= kWheelTurn + kWheelShare * turn->angle &&
        off.translation().norm() <= kWheelTurn + kWheelShare * way.norm()) {
      judgement.verdict = Verdict::kOutvoted;
    }
  }
  // What vision does not see turning says nothing of the gyro's axes.
  const bool informative =
      turn->seen > kTellingTurn * turn->sigma || judgement.verdict == Verdict::kOutvoted;
  count(informative, judgement.verdict);
  if (judgement.verdict == Verdict::kAgrees) {
    learn_bias(*turn, motion->dt, seen.covariance);
    learn_rest_force(*motion, from, way);
    take_velocity(*motion, from, way);
    ended_ += 0.5 * live_ * live_.transpose();
    ended_sum_ += live_;
    live_.setZero();
    go_on();
    return judgement;
  }
  before_.reset();
  if (judgement.verdict == Verdict::kOutvoted || !believed_) {
    begin(seen);
    judgement.verdict = Verdict::kOutvoted;
    return judgement;
  }
  // The turn from the newest frame on; at first also what has shown over the longer time alone.
  const bool slow = turns_otherwise && live_.isZero() && turn->chi2 <= options_.gate;
  const Vector3d error = slow ? longer->error : turn->error;
  const Vector3d e = seen.T_WB.linear() * error, p = seen.T_WB.translation();
  Twist6 twist;
  twist << missed - p.cross(e), -e;  // a turn by -e about p
  live_ += twist;
  char text[160];
  if (turns_otherwise) {
    std::snprintf(text, sizeof text, "vision and the gyro turn apart, by %.1f deg of %.1f",
                  in_degrees(error).norm(), in_degrees(rotation_vector(motion->R_B0B)).norm());
  } else {
    std::snprintf(text, sizeof text,
                  "vision has jumped to %.2f m/s of what the accelerometer does not tell",
                  followed_.norm());
  }
  judgement.reason = text;
  ++contradicted_;
  take_velocity(*motion, from, way);
  go_on();
  // Over a second that holds a jump all would be wrong.
  if (turn->chi2 > options_.gate) frames_ = {{seen.stamp, seen.T_WB}};
  return judgement;
}

bool InertialWitness::jumped(const std::optional<Way>& by_imu, const Vector3d& way,
                             const ImuMotion& motion, double stamp, Vector3d& missed) {
  const double dt = motion.dt;
  if (by_imu && by_imu->variance > 0.0) {
    const Vector3d jump = way - by_imu->way;
    const double sigma = position_sigma(way), variance = by_imu->variance + 2.0 * sigma * sigma;
    if (jump.squaredNorm() > options_.gate * variance) {
      if (followed_.isZero()) {
        followed_variance_ = 0.0;
        followed_since_ = stamp;
      }
      followed_ += jump / dt;
      followed_variance_ += variance / (dt * dt);
      if (followed_.squaredNorm() < options_.gate * followed_variance_) followed_.setZero();
      missed = -jump;
      return true;  // to the frame that is right again, too
    }
  }
  if (stamp - followed_since_ > kFollowed) followed_.setZero();
  missed = -followed_ * dt;
  return !followed_.isZero();
}

Matrix6d InertialWitness::doubt(const Isometry3d& T_CW) const {
  const Matrix6d Ad = adjoint(T_CW);
  return Ad * (ended_ + 0.5 * live_ * live_.transpose()) * Ad.transpose();
}

Matrix6d InertialWitness::doubt_since(const Twist6& then, const Isometry3d& T_CW) const {
  const Twist6 since = adjoint(T_CW) * (sum() - then);
  return 0.5 * since * since.transpose();
}

std::string InertialWitness::complaint() const {
  return believed_ ? ""
                   : "the IMU turns otherwise than the images: it is not believed; expected its "
                     "axes in B and rad/s";
}

double InertialWitness::gyro_bias_sigma() const { return std::sqrt(bias_variance_.maxCoeff()); }

std::optional<Vector3d> InertialWitness::up_in_W() const {
  constexpr double kKnown = 2.0 * kRadiansPerDegree;
  const double force = rest_force_.norm();
  if (!believed_ || !(rest_variance_ > 0.0) || !(std::sqrt(rest_variance_) < kKnown * force)) {
    return std::nullopt;
  }
  return rest_force_ / force;
}

}  // namespace prospect
