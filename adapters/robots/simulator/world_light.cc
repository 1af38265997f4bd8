// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/world_light.h"

#include <cmath>
#include <numbers>

#include "adapters/robots/simulator/hashed_draws.h"
#include "models/sinc.h"

namespace prospect {

WorldLight::WorldLight(const CameraEffects& effects, std::uint64_t seed)
    : light_(effects.light), flicker_(effects.flicker) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  HashedDraws draws(seed);
  for (Wave& wave : waves_) {
    const double direction = draws.uniform(0.0, kTurn), length = draws.uniform(4.0, 10.0);
    wave.number = kTurn / length * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    wave.phase = draws.uniform(0.0, kTurn);
  }
  const double azimuth = draws.uniform(0.0, kTurn), up = draws.uniform(0.09, 0.35);
  window_ << std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up);
  frequency_ = 2.0 * draws.uniform(49.95, 50.05);
  phase_ = draws.uniform(0.0, kTurn);
}

double WorldLight::brightness(const Eigen::Isometry3d& T_WC) const {
  double place = 0.0;
  for (const Wave& wave : waves_) {
    place += std::sin(wave.number.dot(T_WC.translation().head<2>()) + wave.phase);
  }
  place *= std::sqrt(2.0 / static_cast<double>(waves_.size()));
  const double view = std::numbers::sqrt2 * T_WC.linear().col(2).dot(window_);
  return std::exp(light_ * (0.8 * place + 0.6 * view));
}

double WorldLight::lamps(double time, double duration) const {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return 1.0 + flicker_ * sinc(0.5 * kTurn * frequency_ * duration) *
                   std::sin(kTurn * frequency_ * time + phase_);
}

}  // namespace prospect
