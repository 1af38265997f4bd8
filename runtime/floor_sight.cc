// SPDX-License-Identifier: Apache-2.0
#include "runtime/floor_sight.h"

#include <algorithm>
#include <cmath>

namespace prospect {
namespace {

std::optional<FloorSight> sight_of(const DepthSensor& sensor, double base_height, double drop) {
  constexpr int kSteps = 1800;  // of 0.05 degrees
  const RgbdFootprint& f = sensor.footprint;
  const Eigen::Vector3d at = sensor.mount.T_BC.translation();
  const double height = base_height + at.z();
  if (!(height > 0.0)) return std::nullopt;
  std::optional<FloorSight> sight;
  for (int n = 1; n <= kSteps; ++n) {
    const double below = 0.5 * M_PI * n / kSteps;
    if (height / std::sin(below) < f.min_range) continue;
    if ((height + drop) / std::sin(below) > f.max_range) continue;
    const Eigen::Vector3d d = sensor.mount.T_BC.linear().transpose() *
                              Eigen::Vector3d(std::cos(below), 0.0, -std::sin(below));
    const double azimuth = std::atan2(d.x(), d.z());
    const double elevation = std::asin(std::clamp(-d.y(), -1.0, 1.0));
    if (std::abs(azimuth) > 0.5 * f.horizontal_fov || std::abs(elevation) > 0.5 * f.vertical_fov) {
      continue;
    }
    const double x = at.x() + height / std::tan(below);
    if (!sight) sight = FloorSight{x, x};
    sight->from = std::min(sight->from, x);
    sight->to = std::max(sight->to, x);
  }
  return sight;
}

}  // namespace

std::optional<FloorSight> floor_sight(const std::vector<DepthSensor>& sensors, double base_height,
                                      double drop) {
  std::optional<FloorSight> widest;
  for (const DepthSensor& sensor : sensors) {
    const std::optional<FloorSight> sight = sight_of(sensor, base_height, drop);
    if (sight && (!widest || sight->to > widest->to)) widest = sight;
  }
  return widest;
}

double speed_for_sight(double sight, double delay, double deceleration) {
  if (!(sight > 0.0)) return 0.0;
  const double a = deceleration;
  return std::sqrt(a * a * delay * delay + 2.0 * a * sight) - a * delay;
}

}  // namespace prospect
