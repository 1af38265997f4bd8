#include "engine/planner/frontier_planner_options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/task/zone_map.h"
#include "models/can_move.h"

namespace prospect {

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
  options.utility.sensor_fov = std::min(robot.depth.horizontal_fov, 2.0 * M_PI);
  options.traversability.facing = 0.5 * options.utility.sensor_fov;
  // All round there is no side to keep away from; a narrow field is not all margin.
  const bool all_round = options.utility.sensor_fov > 2.0 * M_PI - options.utility.fov_margin;
  options.utility.fov_margin =
      all_round ? 0.0 : std::min(options.utility.fov_margin, options.utility.sensor_fov / 8.0);
  options.traversability.zones = zone_map_of(parameters.zones);
  options.traversability.top_speed = robot.model->max_speed();
  options.area = parameters.task.area;
  options.cost_to_go.v_max = robot.model->max_speed();
  options.turn_price = robot.model->max_speed() / robot.model->max_yaw_rate();
  options.cost_to_go.features_required = parameters.features.N_req;
  return options;
}

}  // namespace prospect
