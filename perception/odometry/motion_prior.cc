// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/motion_prior.h"

#include <cmath>

namespace prospect {
namespace {

constexpr double kStatedFor = 3.0;  // motions
constexpr double kMemory = 20.0;    // motions after which one counts for 1/e
/// What a pose that was just found is off by itself, beside which no acceleration shows [m], [rad].
constexpr double kPositionNoise = 0.003, kRotationNoise = 0.002;

}  // namespace

MotionPrior::MotionPrior(const MotionPriorOptions& options) {
  translation_.stated = options.acceleration * options.acceleration;
  translation_.noise = kPositionNoise * kPositionNoise;
  rotation_.stated = options.turn_acceleration * options.turn_acceleration;
  rotation_.noise = kRotationNoise * kRotationNoise;
}

double MotionPrior::Level::degrees() const { return kStatedFor + count; }

double MotionPrior::Level::variance() const { return (kStatedFor * stated + sum) / degrees(); }

void MotionPrior::add(const Vector6d& change, double dt) {
  const double scale = dt * dt;
  const auto enter = [&](Level& level, const Eigen::Vector3d& part) {
    const double keep = 1.0 - 1.0 / kMemory;
    level.sum = keep * level.sum + part.squaredNorm() / 3.0 / (scale * scale);
    level.count = keep * level.count + 1.0;
  };
  enter(translation_, change.head<3>());
  enter(rotation_, change.tail<3>());
}

double MotionPrior::log_likelihood(const Vector6d& change, double dt) const {
  const double scale = dt * dt;
  const auto part = [&](const Level& level, const Eigen::Vector3d& x) {
    const double variance = level.variance() * scale * scale + level.noise;
    const double nu = level.degrees();
    return -0.5 * (nu + 3.0) * std::log1p(x.squaredNorm() / (nu * variance));
  };
  return part(translation_, change.head<3>()) + part(rotation_, change.tail<3>());
}

}  // namespace prospect
