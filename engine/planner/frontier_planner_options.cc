// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/frontier_planner_options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/task/zone_map.h"
#include "models/can_move.h"

namespace prospect {
namespace {

/// Twice the angle to either side of the first depth sensor's axis that sensors have in view
/// without a gap, to its range at least [rad], up to 2 pi: frontiers are looked at by one field of
/// view.
double field_of_view(const RobotDescription& robot) {
  const auto azimuth = [](const CameraMount& mount) {
    const Eigen::Vector3d axis = mount.T_BC.linear().col(2);
    return std::atan2(axis.y(), axis.x());
  };
  const double middle = azimuth(robot.depth_mount);
  double half[] = {0.5 * robot.depth.horizontal_fov, 0.5 * robot.depth.horizontal_fov};
  // Each round joins a sensor at least, or ends.
  for (std::size_t round = 0; round < robot.more_depth.size(); ++round) {
    for (const DepthSensor& sensor : robot.more_depth) {
      if (sensor.footprint.max_range < robot.depth.max_range) continue;
      const double wide = 0.5 * sensor.footprint.horizontal_fov;
      for (const int side : {0, 1}) {
        // The sensor's axis from the first one's, towards this side.
        double at = side == 0 ? azimuth(sensor.mount) - middle : middle - azimuth(sensor.mount);
        at -= 2.0 * M_PI * std::floor(at / (2.0 * M_PI));
        for (const double turned : {at, at - 2.0 * M_PI}) {
          if (turned - wide <= half[side]) half[side] = std::max(half[side], turned + wide);
        }
      }
    }
  }
  if (half[0] + half[1] >= 2.0 * M_PI) return 2.0 * M_PI;
  return 2.0 * std::min(half[0], half[1]);
}

}  // namespace

FrontierPlannerOptions frontier_planner_options_for(const RobotDescription& robot,
                                                    const PlannerParameters& parameters) {
  if (!robot.model) throw std::invalid_argument("planner: no motion model; expected one");
  validate(robot.shape);
  validate(robot.depth);
  FrontierPlannerOptions options = parameters.frontier_planner;
  const double radius = circumscribed_radius(robot.shape);
  options.traversability.hard_radius =
      radius + std::max(parameters.d_safe, parameters.certificate_margin);
  options.traversability.comfortable_radius =
      std::max(options.traversability.hard_radius, radius + parameters.d_des * 0.7);
  options.traversability.body.reset();
  if (!is_round(robot.shape)) options.traversability.body = robot.shape;
  options.traversability.free_moves = can_move(*robot.model, -Eigen::Vector2d::UnitX()) ||
                                      can_move(*robot.model, Eigen::Vector2d::UnitY());
  // From farther away nothing needs to be looked at.
  constexpr double kFarView = 50.0;
  options.frontiers.sensor_range = std::min(robot.depth.max_range, kFarView);
  options.frontiers.range_margin =
      std::min(options.frontiers.range_margin, 0.25 * options.frontiers.sensor_range);
  options.utility.sensor_range = options.frontiers.sensor_range;
  options.utility.sensor_fov = std::min(field_of_view(robot), 2.0 * M_PI);
  options.traversability.facing = 0.5 * options.utility.sensor_fov;
  // All round there is no side to keep away from; a narrow field is not all margin.
  const bool all_round = options.utility.sensor_fov > 2.0 * M_PI - options.utility.fov_margin;
  options.utility.fov_margin =
      all_round ? 0.0 : std::min(options.utility.fov_margin, options.utility.sensor_fov / 8.0);
  options.traversability.zones = zone_map_of(parameters.zones);
  options.traversability.top_speed = robot.model->max_speed();
  options.area = parameters.task.area;
  options.cost_to_go.v_max = robot.model->max_speed();
  options.turn_time = 1.0 / robot.model->max_yaw_rate();
  options.cost_to_go.features_required = parameters.features.N_req;
  return options;
}

}  // namespace prospect
