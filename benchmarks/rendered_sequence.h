// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "models/camera.h"
#include "tests/perception/rendered_room.h"

namespace prospect {

/// A room of either contrast, seen from a camera that goes and turns at a random constant speed of
/// an indoor robot: 0 to 0.8 m/s and to 30 degrees a second at 10 images/s, some sideways. Poses
/// are exact, so errors are the odometry's alone. The same number gives the same sequence.
class RenderedSequence {
 public:
  static constexpr double kPeriod = 0.1;  ///< [s] between frames

  RenderedSequence(int number, int frames)
      : number_(number), room_(number % 3 == 2 ? 35.0 : 70.0), path_(random_path(number, frames)) {}

  /// Images of this width, three quarters as high [px].
  static StereoCamera camera(double width = 480.0) {
    StereoCamera camera;
    const double scale = width / 480.0;
    camera.left = {330.0 * scale, 330.0 * scale, 240.0 * scale, 180.0 * scale, width, 0.75 * width};
    return camera;
  }

  const std::vector<Eigen::Isometry3d>& path() const { return path_; }  ///< T_WC of each frame

  test::RenderedRoom::Pair render(const StereoCamera& camera, int frame) const {
    return room_.render(camera, path_[static_cast<std::size_t>(frame)], 2.0,
                        static_cast<std::uint64_t>(1000 * number_ + frame));
  }

  /// What one camera sees from any pose, without noise.
  Image image(const PinholeCamera& camera, const Eigen::Isometry3d& T_WC) const {
    return room_.render(camera, T_WC, 0.0, 0);
  }
  int number() const { return number_; }

 private:
  /// Level poses from a random start, at least 0.4 m from the walls.
  static std::vector<Eigen::Isometry3d> random_path(int seed, int frames) {
    std::mt19937 generator(static_cast<std::uint32_t>(seed + 1));
    const auto between = [&](double low, double high) {
      return low + (high - low) * (generator() >> 8) / static_cast<double>(1 << 24);
    };
    double x = between(-1.8, -0.3), y = between(-1.2, 1.2), yaw = between(-1.0, 1.0);
    const double forward = between(0.0, 0.08), turn = between(-0.05, 0.05);
    const double sideways = seed % 4 == 3 ? between(-0.04, 0.04) : 0.0;
    std::vector<Eigen::Isometry3d> path;
    for (int k = 0; k < frames; ++k) {
      path.push_back(test::RenderedRoom::looking(x, y, 1.05, yaw));
      x = std::clamp(x + forward * std::cos(yaw) - sideways * std::sin(yaw), -2.6, 2.0);
      y = std::clamp(y + forward * std::sin(yaw) + sideways * std::cos(yaw), -2.1, 2.3);
      yaw += turn;
    }
    return path;
  }

  int number_;
  test::RenderedRoom room_;
  std::vector<Eigen::Isometry3d> path_;
};

}  // namespace prospect
