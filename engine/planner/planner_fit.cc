// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/planner_fit.h"

#include <algorithm>
#include <cmath>

#include "engine/maps/clearance_field.h"
#include "engine/planner/planner.h"
#include "models/formatted.h"

namespace prospect {
namespace {

constexpr double kLeastCutoff = 0.8;  // [m]
constexpr double kBeyond = 0.2;       // [m]

std::string text(double value) { return formatted("%.4g", value); }

/// The body's radius and what is added to it [m].
double cutoff_needed(const RobotDescription& robot, const PlannerParameters& p) {
  return circumscribed_radius(robot.shape) + p.d_des + p.drift_margin + kBeyond;
}

std::string distances_misfit(const RobotDescription& robot, const PlannerParameters& p,
                             double resolution) {
  const bool in_space = robot.model->pose_layout().pz >= 0;
  const int most = in_space ? ClearanceField::kMostVoxelsInSpace : ClearanceField::kMostVoxels;
  const double cutoff = clearance_cutoff(robot, p, resolution);
  if (ClearanceField::reaches(cutoff, resolution, in_space)) return "";
  const double needed = cutoff_needed(robot, p);
  std::string why = "planner.d_des is " + text(p.d_des) + " m: with the body's radius of " +
                    text(circumscribed_radius(robot.shape)) + " m and planner.drift_margin of " +
                    text(p.drift_margin) + " m it takes distances up to " + text(cutoff) + " m, " +
                    text(std::ceil(cutoff / resolution)) + " voxels at a resolution of " +
                    text(resolution) + " m; expected at most " + std::to_string(most) + " voxels: ";
  const double allowed = p.d_des - (needed - most * resolution);
  if (allowed >= p.d_safe && allowed >= 0.01 && kLeastCutoff <= most * resolution) {
    why += "a d_des of at most " + text(std::floor(1e3 * allowed) / 1e3) + " m, or ";
  }
  return why + "a perception.mapping.resolution of at least " +
         text(std::ceil(1e4 * cutoff / most) / 1e4) + " m";
}

std::string window_misfit(const PlannerParameters& p, double resolution) {
  const double radius = p.frontier_planner.cost_to_go.window_radius;
  if (radius <= kMostWindow * resolution * (1.0 + 1e-9)) return "";
  return "planner.frontiers.window_radius is " + text(radius) + " m, " +
         text(std::ceil(radius / resolution)) + " voxels at a resolution of " + text(resolution) +
         " m; expected at most " + std::to_string(kMostWindow) +
         " voxels: " + text(kMostWindow * resolution) +
         " m, or a perception.mapping.resolution of at least " + text(radius / kMostWindow) + " m";
}

std::string variables_misfit(const RobotDescription& robot, const PlannerParameters& p) {
  const int nu = robot.model->nu(), variables = p.M * nu;
  if (variables <= kMostVariables) return "";
  return "planner.M is " + std::to_string(p.M) + ": knots of " + std::to_string(nu) +
         " inputs are " + std::to_string(variables) + " variables; expected at most " +
         std::to_string(kMostVariables) + ", an M of at most " +
         std::to_string(kMostVariables / nu);
}

std::string views_misfit(const PlannerParameters& p) {
  const bool timed = p.deadline > 0.0;
  const double most =
      timed ? std::clamp(kMostViewsPerSecond * p.deadline, kLeastViews, kMostViews) : kMostViews;
  if (static_cast<double>(p.N) * p.max_landmarks <= most) return "";
  return "planner.N is " + std::to_string(p.N) + " and planner.max_landmarks " +
         std::to_string(p.max_landmarks) + ": each evaluation looks at " +
         text(static_cast<double>(p.N) * p.max_landmarks) + " landmarks; expected at most " +
         text(most) +
         (timed ? " with a planner.deadline of " + text(p.deadline) + " s" : std::string()) +
         ", a max_landmarks of at most " + std::to_string(static_cast<int>(most / p.N));
}

std::string motion_misfit(const RobotDescription& robot, const PlannerParameters& p) {
  constexpr double kRest = 1e-3;  // [m/s]
  const double horizon = p.N * p.dt;
  const double a = robot.model->max_deceleration();
  if (a * horizon > kRest) return "";
  return "robot.motion: the weakest acceleration is " + text(a) +
         " m/s2: within the horizon of planner.N planner.dt = " + text(horizon) +
         " s the robot gets to " + text(a * horizon) + " m/s, which is rest; expected more than " +
         text(kRest / horizon) + " m/s2";
}

}  // namespace

double clearance_cutoff(const RobotDescription& robot, const PlannerParameters& parameters,
                        double resolution) {
  return std::max({kLeastCutoff, cutoff_needed(robot, parameters), resolution});
}

std::string planner_misfit(const RobotDescription& robot, const PlannerParameters& parameters,
                           double resolution) {
  for (const std::string& why : {motion_misfit(robot, parameters),
                                 variables_misfit(robot, parameters), views_misfit(parameters)}) {
    if (!why.empty()) return why;
  }
  if (!(resolution > 0.0)) return "";
  const std::string why = distances_misfit(robot, parameters, resolution);
  return why.empty() ? window_misfit(parameters, resolution) : why;
}

}  // namespace prospect
