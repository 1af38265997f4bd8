// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "models/camera.h"
#include "perception/mapping/depth_image.h"

namespace prospect::test {

/// A box-shaped room with boxes in it, seen by an ideal depth camera. World: z up, floor z = 0.
struct DepthScene {
  struct Box {
    Eigen::Vector3d low, high;
  };
  Box room{{-2.03, -2.52, 0.0}, {4.07, 2.57, 2.61}};
  std::vector<Box> boxes;

  /// Depth along the optical axis of what pixel (u, v) shows [m].
  double depth(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, double u,
               double v) const {
    const Eigen::Vector3d ray = T_WC.linear() * pixel_ray(camera, u, v);
    const Eigen::Vector3d from = T_WC.translation();
    double t = 1e9;
    for (int i = 0; i < 3; ++i) {
      if (ray[i] > 0) t = std::min(t, (room.high[i] - from[i]) / ray[i]);
      if (ray[i] < 0) t = std::min(t, (room.low[i] - from[i]) / ray[i]);
    }
    for (const Box& box : boxes) {
      double enter = 0.0, leave = 1e9;
      for (int i = 0; i < 3; ++i) {
        const double a = (box.low[i] - from[i]) / ray[i], b = (box.high[i] - from[i]) / ray[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter > 0.0 && enter < leave) t = std::min(t, enter);
    }
    return t;  // the ray's component along the optical axis is 1
  }

  /// Image with Gaussian noise of standard deviation `noise` z^2 [1/m].
  DepthImage render(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC, double noise = 0.0,
                    std::uint64_t seed = 1, const DepthRange& range = {}) const {
    DepthImage image(static_cast<int>(camera.width), static_cast<int>(camera.height));
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        double z = depth(camera, T_WC, u, v);
        if (noise > 0.0) z += noise * z * z * normal(generator);
        if (range.holds(z)) image.at(u, v) = static_cast<float>(z);
      }
    }
    return image;
  }

  /// A camera at (x, y, z) looking along `yaw` from the world's x axis, pitched down by `pitch`,
  /// the image's right side down by `roll` [rad].
  static Eigen::Isometry3d looking(double x, double y, double z, double yaw, double pitch = 0.0,
                                   double roll = 0.0) {
    Eigen::Isometry3d T = CameraMount::forward_facing({x, y, z}, yaw, pitch);
    T.rotate(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
    return T;
  }
};

}  // namespace prospect::test
