// SPDX-License-Identifier: Apache-2.0
#include "engine/task/moved.h"

#include <Eigen/Geometry>
#include <utility>

namespace prospect {

Eigen::Vector2d moved(const Eigen::Vector2d& in_B, const Pose& T_AB) {
  return T_AB.position.head<2>() + Eigen::Rotation2Dd(T_AB.yaw) * in_B;
}

Polygon moved(Polygon in_B, const Pose& T_AB) {
  for (Eigen::Vector2d& corner : in_B) corner = moved(corner, T_AB);
  return in_B;
}

Zones moved(Zones in_B, const Pose& T_AB) {
  if (in_B.bound) in_B.bound = moved(std::move(*in_B.bound), T_AB);
  for (Polygon& polygon : in_B.keep_out) polygon = moved(std::move(polygon), T_AB);
  for (SpeedZone& zone : in_B.slow) zone.area = moved(std::move(zone.area), T_AB);
  return in_B;
}

Task moved(Task in_B, const Pose& T_AB) {
  if (in_B.area) in_B.area = moved(std::move(*in_B.area), T_AB);
  if (in_B.kind != TaskKind::kGoTo) return in_B;
  in_B.goal.position = moved(in_B.goal.position, T_AB);
  if (in_B.goal.yaw) *in_B.goal.yaw += T_AB.yaw;
  return in_B;
}

}  // namespace prospect
