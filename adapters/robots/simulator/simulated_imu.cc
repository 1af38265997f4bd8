// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/simulated_imu.h"

#include <Eigen/Geometry>
#include <cmath>

#include "models/sinc.h"

namespace prospect {

SimulatedImu::SimulatedImu(const SimulatedImuOptions& options, std::uint64_t seed)
    : options_(options), noise_(seed) {
  gyro_bias_ = drawn(options.gyro_bias);
  acceleration_bias_ = drawn(options.acceleration_bias);
}

Eigen::Vector3d SimulatedImu::drawn(double sigma) {
  const double x = normal_(noise_), y = normal_(noise_), z = normal_(noise_);
  return sigma * Eigen::Vector3d(x, y, z);
}

std::vector<ImuSample> SimulatedImu::moved(const Pose& before, double from, const Pose& after,
                                           double until) {
  std::vector<ImuSample> samples;
  if (!(options_.rate > 0.0) || !(until > from)) return samples;
  constexpr double kGravity = 9.81;  // [m/s^2]
  const double period = 1.0 / options_.rate, time = until - from;
  const double turned = std::remainder(after.yaw - before.yaw, 2.0 * M_PI), w = turned / time;
  // p' = p + t sinc(turned / 2) R(yaw + turned / 2) v
  const Eigen::Vector2d way = (after.position - before.position).head<2>();
  const Eigen::Vector2d v =
      Eigen::Rotation2Dd(-(before.yaw + 0.5 * turned)) * way / (time * sinc(0.5 * turned));
  while (true) {
    const double stamp = static_cast<double>(count_ + 1) * period;
    if (stamp > until) return samples;
    ++count_;
    const Eigen::Vector2d a = (v - velocity_) / period + w * Eigen::Vector2d(-v.y(), v.x());
    velocity_ = v;
    ImuSample sample;
    sample.stamp = stamp;
    sample.angular_velocity =
        Eigen::Vector3d(0.0, 0.0, w) + gyro_bias_ + drawn(options_.gyro_noise);
    sample.linear_acceleration = Eigen::Vector3d(a.x(), a.y(), kGravity) + acceleration_bias_ +
                                 drawn(options_.acceleration_noise);
    samples.push_back(sample);
  }
}

}  // namespace prospect
