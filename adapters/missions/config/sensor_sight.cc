// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/sensor_sight.h"

#include <algorithm>
#include <cmath>

#include "engine/maps/map_projection.h"
#include "models/formatted.h"

namespace prospect {
namespace {

/// Largest value of a cos t + b sin t over |t| <= half.
double largest(double a, double b, double half) {
  const double at = std::atan2(b, a);
  if (std::abs(at) <= half) return std::hypot(a, b);
  return std::max(a * std::cos(half) + b * std::sin(half), a * std::cos(half) - b * std::sin(half));
}

/// Largest component along `up`, in C, of the directions of a footprint
/// (sin a cos e, -sin e, cos a cos e). cos e >= 0, so the best azimuth is the same at all
/// elevations.
double steepest(const RgbdFootprint& f, const Eigen::Vector3d& up) {
  const double level = largest(up.z(), up.x(), 0.5 * f.horizontal_fov);
  return largest(level, -up.y(), 0.5 * f.vertical_fov);
}

}  // namespace

VerticalExtent heights_of_rays(const RgbdFootprint& footprint, const CameraMount& mount,
                               double base_height) {
  const double height = base_height + mount.T_BC.translation().z();
  const Eigen::Vector3d up = mount.T_BC.linear().row(2);
  return {height - footprint.max_range * std::max(0.0, steepest(footprint, -up)),
          height + footprint.max_range * std::max(0.0, steepest(footprint, up))};
}

std::string sight_problem(const RobotDescription& robot, const DepthSensor& sensor,
                          double resolution) {
  if (robot.model->pose_layout().pz >= 0) return "";
  const SliceLayers layers = slice_layers(height_slice(robot), resolution);
  const VerticalExtent rays = heights_of_rays(sensor.footprint, sensor.mount, robot.base_height());
  const double low = layers.k_low * resolution, high = (layers.k_high + 1) * resolution;
  constexpr double kRounding = 1e-9;  // as the map has it: what is on a face is above it
  if (rays.z_max >= low - kRounding && rays.z_min < high - kRounding) return "";
  return formatted(
      "its rays run %.3f to %.3f m above the floor, the body is in the layers of voxels "
      "from %.3f to %.3f m: nothing of them would be seen; expected a sensor that looks "
      "into them, or a body (robot.shape) that reaches up to it",
      rays.z_min, rays.z_max, low, high);
}

}  // namespace prospect
