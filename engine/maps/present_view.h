// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/maps/belief.h"
#include "engine/maps/free_line.h"
#include "engine/maps/grid.h"
#include "models/body_transform.h"
#include "models/camera.h"
#include "models/robot_description.h"
#include "models/robot_shape.h"

namespace prospect {

/// Calls visit(cell) for the ground cells that a depth sensor has in view from a pose: those that
/// rays over the ground meet, up to and with the first that is not seen through, within its range
/// and horizontal field of view (rays half a cell apart at max_range, 1e5 at most); an occupied
/// cell only from min_range on, a low obstacle only from where the sensor's lower edge meets the
/// floor on. A cell may be visited several times. The pose is finite.
template <typename Visit>
void visit_ground_in_view(const GroundMap& ground, const Pose& pose, const DepthSensor& sensor,
                          Visit&& visit) {
  const GridFrame& frame = ground.frame();
  const RgbdFootprint& depth = sensor.footprint;
  const Eigen::Isometry3d T_WC = body_transform(pose) * sensor.mount.T_BC;
  const Eigen::Vector3d axis = T_WC.linear().col(2);
  const Eigen::Vector2d eye = T_WC.translation().head<2>();
  const double yaw = std::atan2(axis.y(), axis.x());
  const double pitch = std::asin(std::clamp(-axis.z(), -1.0, 1.0));  // downward
  // Nearer than this the sensor looks over what is low.
  const double lowest = 0.5 * depth.vertical_fov + pitch;
  const double near_low = lowest <= 0.0         ? std::numeric_limits<double>::infinity()
                          : lowest < 0.5 * M_PI ? T_WC.translation().z() / std::tan(lowest)
                                                : 0.0;
  const double range = depth.max_range;
  const double wanted = std::ceil(depth.horizontal_fov * range / (0.5 * frame.resolution));
  const int rays = static_cast<int>(std::clamp(wanted, 2.0, 1e5));
  for (int n = 0; n <= rays; ++n) {
    const double azimuth = yaw + depth.horizontal_fov * (static_cast<double>(n) / rays - 0.5);
    const Eigen::Vector2d end = eye + range * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
    visit_line(frame, eye, end, [&](Cell c) {
      const CellState state = ground.state(c);
      if (state == CellState::kUnknown) return false;
      if (state == CellState::kFree) {
        visit(c);
        return true;
      }
      const bool low = ground.see_through(c);
      const double distance = (frame.center(c) - eye).norm();
      if (distance >= (low ? std::max(near_low, depth.min_range) : depth.min_range)) visit(c);
      return low;
    });
  }
}

/// What a robot may drive into when nothing bounds the error of its pose (pose_error.h): what its
/// depth sensor has before it now, at the belief's pose and on the belief's map.
///
/// Planar bases: the ground cells of visit_ground_in_view(). Bases that move in 3-D: the voxels
/// whose centre is within range and both fields of view, with nothing but known free voxels on the
/// line to it.
///
/// The field of view starts at a point and the body is broad: ground beside that point which the
/// body meets when it drives straight ahead is not in view any more when it gets there. Such ground
/// is *passed by*: it is ahead of the body's rear and within its width (widened by kSlope of what
/// it may drive before it is in view), in 3-D also within its height, and the first point straight
/// ahead of it that the field of view covers is in view. It may be entered by a body that
/// keeps_to() the strip ahead: its sides leave that of the start by no more than kSlope of the path
/// ahead. So all that a robot sweeps which drives on like that was in view a body's width before;
/// sideways, backwards and into what hides the view there is nothing to be gained, however often it
/// starts.
///
/// Immutable; concurrent reads are safe. Errors: none for a finite pose and non-null maps. The cost
/// is bounded by the map: `visits` counts the cells and voxels that were looked at.
/// Source: our choice.
class PresentView {
 public:
  PresentView(const Belief& belief, const DepthSensor& sensor, const RobotShape& shape,
              bool planar);

  static constexpr double kSlope = 0.2;

  bool shows(Cell c) const;                        ///< planar
  bool shows(const Eigen::Vector3i& voxel) const;  ///< in 3-D
  bool passes_by(Cell c) const;                    ///< of what it does not show; planar
  bool passes_by(const Eigen::Vector3i& voxel) const;
  bool keeps_to(const Pose& pose) const;
  long long visits() const { return visits_; }

 private:
  bool covers(const Eigen::Vector3d& point) const;  // by the field of view
  bool sees(const Eigen::Vector3d& point) const;
  bool passes_by(const Eigen::Vector3d& center, double half) const;

  const VoxelGrid* voxels_;
  DepthSensor sensor_;
  RobotShape shape_;
  bool planar_;
  Eigen::Isometry3d T_CW_;
  Eigen::Vector3d eye_, origin_, along_, across_;  // in W; along and across: horizontal
  double rear_ = 0.0, right_ = 0.0, left_ = 0.0;   // of the body, along and across [m]
  VerticalExtent extent_{0.0, 0.0};                // of the body in W
  Grid<std::uint8_t> in_view_;                     // planar
  mutable long long visits_ = 0;
};

}  // namespace prospect
