// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "engine/features/visibility_prediction.h"
#include "engine/maps/landmark_map.h"
#include "engine/problem/trajectory.h"
#include "models/camera.h"
#include "models/motion_model.h"

namespace prospect::visibility_scene {

inline double uniform(std::mt19937_64& rng, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(rng);
}

inline Eigen::Vector3d normal3(std::mt19937_64& rng) {
  std::normal_distribution<double> n;
  const double a = n(rng), b = n(rng), c = n(rng);
  return {a, b, c};
}

/// A random positive definite covariance with standard deviations of about `deviation`.
inline Eigen::Matrix3d covariance(std::mt19937_64& rng, double deviation) {
  Eigen::Matrix3d L;
  for (int i = 0; i < 3; ++i) L.col(i) = deviation * normal3(rng);
  return L * L.transpose() / 3.0 + 0.01 * deviation * deviation * Eigen::Matrix3d::Identity();
}

/// Landmarks all around, created by cameras near the origin.
inline std::vector<Landmark> landmarks(std::mt19937_64& rng, int count, double deviation = 0.03) {
  std::vector<Landmark> result;
  for (int i = 0; i < count; ++i) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(i + 1);
    const double azimuth = uniform(rng, -3.14159, 3.14159);
    const double range = uniform(rng, 0.3, 6.0);
    l.position = {range * std::cos(azimuth), range * std::sin(azimuth), uniform(rng, 0.0, 2.0)};
    l.covariance = covariance(rng, deviation);
    const Eigen::Vector3d creator(uniform(rng, -0.7, 0.7), uniform(rng, -0.7, 0.7), 0.45);
    l.creation_direction = (creator - l.position).normalized();
    l.creation_range = (creator - l.position).norm();
    l.survival = uniform(rng, 0.5, 1.0);
    // Every second one stands for others as well.
    if (i % 2 == 1) l.multiplicity = uniform(rng, 0.5, 4.0);
    // Every third one is crowded, some alone in their cell and some one of several.
    if (i % 3 == 2) l.per_cell = uniform(rng, 0.0, 1.5);
    result.push_back(l);
  }
  return result;
}

/// B random smooth walks, about `speed` [m/s] and `turn` [rad/s]; states other than the pose
/// random.
inline TrajectoryBatch walks(std::mt19937_64& rng, const MotionModel& model, int N, double dt,
                             int B, double speed = 0.4, double turn = 0.5) {
  TrajectoryBatch t;
  t.horizon.model = &model;
  t.horizon.N = N;
  t.horizon.dt = dt;
  t.layout = model.pose_layout();
  t.u_previous = Eigen::VectorXd::Zero(model.nu());
  t.states.setZero((N + 1) * model.nx(), B);
  t.inputs.setZero(N * model.nu(), B);
  const int nx = model.nx();
  for (int b = 0; b < B; ++b) {
    double x = uniform(rng, -0.5, 0.5), y = uniform(rng, -0.5, 0.5);
    double z = uniform(rng, -0.2, 0.3), yaw = uniform(rng, -3.0, 3.0);
    for (int k = 0; k <= N; ++k) {
      for (int i = 0; i < nx; ++i) t.states(k * nx + i, b) = uniform(rng, -1.0, 1.0);
      t.states(k * nx + t.layout.px, b) = x;
      t.states(k * nx + t.layout.py, b) = y;
      if (t.layout.pz >= 0) t.states(k * nx + t.layout.pz, b) = z;
      t.states(k * nx + t.layout.yaw, b) = yaw;
      const double step = speed * dt * uniform(rng, 0.0, 2.0);
      x += step * std::cos(yaw);
      y += step * std::sin(yaw);
      z += 0.3 * step * uniform(rng, -1.0, 1.0);
      yaw += turn * dt * uniform(rng, -2.0, 2.0);
    }
  }
  return t;
}

inline TermOutput output(const TrajectoryBatch& t) {
  TermOutput out;
  out.value = BatchArray::Zero(1, t.batch());
  out.state_gradient = BatchArray::Zero(t.states.rows(), t.batch());
  out.input_gradient = BatchArray::Zero(t.inputs.rows(), t.batch());
  return out;
}

}  // namespace prospect::visibility_scene
