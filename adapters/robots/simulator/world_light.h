// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "adapters/robots/simulator/camera_effects.h"

namespace prospect {

/// The light of a world, as a function of the seed: how bright it is where a camera looks from and
/// to, where a window is, and how its lamps flicker. A value.
class WorldLight {
 public:
  WorldLight(const CameraEffects& effects, std::uint64_t seed);

  /// exp(light n): of n 0.8 are waves of 4 to 10 m over the floor, 0.6 the cosine of the view to
  /// the window, each of variance 1.
  double brightness(const Eigen::Isometry3d& T_WC) const;
  /// Mean of the lamps' light over an exposure of `duration` about `time` [s]:
  ///   1 + flicker sinc(pi F duration) sin(2 pi F time + phase),  F = 2 x (50 +- 0.05) Hz.
  double lamps(double time, double duration) const;
  /// Direction to the window in W, far away, 5 to 20 degrees up.
  const Eigen::Vector3d& window() const { return window_; }

 private:
  struct Wave {
    Eigen::Vector2d number;  // [rad/m]
    double phase;
  };
  double light_, flicker_;
  std::array<Wave, 3> waves_;
  Eigen::Vector3d window_;
  double frequency_, phase_;  // of the lamps [Hz], [rad]
};

}  // namespace prospect
