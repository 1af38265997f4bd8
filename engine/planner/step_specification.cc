// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/step_specification.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/features/tracked_calibration.h"
#include "engine/frontiers/exploration_targets.h"
#include "engine/planner/planner_fit.h"
#include "engine/planner/step_monitors.h"
#include "models/body_transform.h"
#include "models/depth_sensors.h"

namespace prospect {
namespace {

/// How far the base can get within the horizon [m].
double reach(const StepContext& c) {
  return c.robot.model->max_speed() * c.parameters.N * c.parameters.dt;
}

bool is_vertical(const StepContext& c) { return c.robot.model->pose_layout().pz >= 0; }

Eigen::Vector3d camera_position(const StepContext& c, const CameraMount& mount) {
  return body_transform(c.belief.pose) * mount.T_BC.translation();
}

/// How far a camera can get from where it is now [m].
double camera_reach(const StepContext& c, const CameraMount& mount) {
  return reach(c) + mount.T_BC.translation().head<2>().norm();
}

void specify_robot_and_horizon(const StepContext& c, ProblemSpecification& s) {
  const MotionModel& model = *c.robot.model;
  const InputLimits& limits = model.limits();
  s.robot = c.robot;
  s.x0 = model.state(c.belief.pose, c.belief.twist);
  s.u_previous = model.input(c.belief.command.value_or(c.belief.twist))
                     .cwiseMax(limits.lower)
                     .cwiseMin(limits.upper);
  s.N = c.parameters.N;
  s.dt = c.parameters.dt;
  s.M = c.parameters.M;
  Twist desired;
  desired.linear.x() = c.parameters.desired_speed * model.max_speed();
  s.desired_input = model.input(desired);
  s.voxels = c.belief.voxels;
  s.ground = c.belief.ground;
}

/// Movers that the robot can meet within the horizon, the nearest first.
std::vector<Mover> movers_in_reach(const StepContext& c, double d_des) {
  constexpr std::size_t kMost = 8;  // each costs an evaluation what a body's clearance does
  std::vector<Mover> near;
  const double horizon = c.parameters.N * c.parameters.dt;
  const Eigen::Vector2d here = c.belief.pose.position.head<2>();
  for (const Mover& now : predicted(c.belief.movers.get(), c.belief.stamp)) {
    if (!now.sound()) continue;  // such a belief gets no certificate
    const double meets = reach(c) + circumscribed_radius(c.robot.shape) + d_des +
                         now.velocity.norm() * horizon + now.reach(horizon);
    if ((now.position - here).norm() < meets) near.push_back(now);
  }
  std::stable_sort(near.begin(), near.end(), [&](const Mover& a, const Mover& b) {
    return (a.position - here).norm() - a.radius < (b.position - here).norm() - b.radius;
  });
  if (near.size() > kMost) near.resize(kMost);
  return near;
}

void specify_obstacles(const StepContext& c, ProblemSpecification& s) {
  const PlannerParameters& p = c.parameters;
  const MotionModel& model = *c.robot.model;
  const SafetyLevelPolicy& rules = policy(c.safety_level);
  const double radius = circumscribed_radius(c.robot.shape);
  s.clearance_center = c.belief.pose.position;
  s.clearance_field.vertical = is_vertical(c);
  s.clearance_field.slice = c.robot.slice();
  // It is asked where the robot would come to rest, too.
  const double to_stop = model.max_speed() * model.max_speed() / (2.0 * model.max_deceleration());
  s.clearance_field.reach = reach(c) + to_stop + 1.0;
  s.clearance_field.cutoff = clearance_cutoff(c.robot, p, c.belief.voxels->resolution());
  const double drifted =
      !rules.drift_in_cost
          ? 0.0
          : std::min(p.drift_margin, c.drift.sigma_near(c.belief.pose.position.head<2>(),
                                                        radius + p.d_des + p.drift_margin));
  s.d_safe = p.d_safe + drifted;
  s.d_des = p.d_des + drifted;
  s.movers = movers_in_reach(c, s.d_des);
  s.clearance.d_safe = rules.hard_clearance ? p.d_safe : 0.0;
  s.clearance.floor = std::min(s.clearance.floor, s.clearance.d_safe);
  s.unknown = p.unknown;
  s.unknown_d_safe = p.d_safe;
  s.zones = c.zones;
}

/// What is in view now counts as it is tracked.
void calibrate(const StepContext& c, ProblemSpecification& s) {
  const Eigen::Vector3d camera = camera_position(c, c.robot.stereo_mount);
  Eigen::VectorXd visible =
      VisibilityPrediction(s.landmarks, c.robot.stereo, c.robot.stereo_mount, nullptr, s.visibility)
          .probabilities(c.belief.pose);
  for (std::size_t i = 0; i < s.landmarks.size(); ++i) {
    double& pi = visible[static_cast<Eigen::Index>(i)];
    if (!(pi > 0.0)) continue;
    const VoxelGrid::Ray ray =
        c.belief.voxels->cast(camera, s.landmarks[i].position, s.landmark_occlusion.trim);
    pi *= ray.blocked ? 0.0 : std::exp(-s.landmark_occlusion.attenuation * ray.unknown_length);
  }
  calibrate_to_tracked(s.landmarks, visible, c.belief.tracked_features);
}

/// Returns how many of the landmarks are mapped ones.
std::size_t specify_visible_features(const StepContext& c, ProblemSpecification& s) {
  const PlannerParameters& p = c.parameters;
  const Eigen::Vector3d camera = camera_position(c, c.robot.stereo_mount);
  s.landmark_occlusion.attenuation = p.feature_attenuation;
  s.landmark_occlusion.trim = 1.5 * c.belief.voxels->resolution();
  s.landmark_occlusion.max_range = p.visibility.r_max + 1.0;
  if (!p.feature_occlusion) s.landmark_occlusion.trim = s.landmark_occlusion.max_range;
  s.visibility = p.visibility;
  s.visibility.odometry = c.landmarks.usable->odometry_noise.value_or(p.visibility.odometry);
  s.landmarks = c.landmarks.mapped;
  const std::size_t num_mapped = s.landmarks.size();
  s.landmarks.insert(s.landmarks.end(), c.landmarks.expected.begin(), c.landmarks.expected.end());
  if (!p.feature_covariance) {
    OdometryNoise& noise = s.visibility.odometry;
    noise.position_per_metre = noise.position_per_radian = 0.0;
    noise.yaw_per_metre = noise.yaw_per_radian = noise.scale = 0.0;
    for (Landmark& landmark : s.landmarks) landmark.covariance.setZero();
  }
  s.landmark_lattice =
      SensorLattice::around(camera, camera_reach(c, c.robot.stereo_mount), p.visibility_lattice,
                            is_vertical(c), positions(s.landmarks), s.landmark_occlusion.max_range);
  if (c.belief.localization != Localization::kLost) calibrate(c, s);

  s.features = p.features;
  if (policy(c.mode).count_features) {
    s.features.criterion = VisibilityCriterion::kCount;
    s.features.N_req = std::max(p.features.N_req, 2.0 * kEnoughToGoOn * p.features.N_min);
  }
  s.features.rho = 0.0;
  return num_mapped;
}

/// Cells of the active frontiers whose gain counts.
std::vector<Cell> frontier_cells(const StepContext& c) {
  const GlobalPlan& plan = c.global_plan;
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < plan.frontiers.size(); ++i) {
    const Frontier& f = plan.frontiers[i];
    const bool chosen = plan.target && plan.target->frontier == static_cast<int>(i);
    if (f.active && (chosen || !c.parameters.target_frontier_only)) {
      cells.insert(cells.end(), f.cells.begin(), f.cells.end());
    }
  }
  return cells;
}

void specify_exploration(const StepContext& c, ProblemSpecification& s) {
  const PlannerParameters& p = c.parameters;
  const std::vector<DepthSensor> sensors = c.robot.depth_sensors();
  s.target_occlusion.attenuation = p.unknown_attenuation;
  s.target_occlusion.trim = 1.5 * c.belief.voxels->resolution();
  s.target_occlusion.max_range = longest_range(c.robot.depth.max_range, c.robot.more_depth) + 1.0;
  ExplorationTargetOptions options;
  options.max_targets = p.max_targets;
  if (c.global_plan.target) options.led_to = c.global_plan.target->looks_at;
  s.targets = exploration_targets(c.belief, frontier_cells(c), sensors, options);
  if (c.zones != nullptr || p.frontier_planner.area) {
    // On the path to an area what is seen outside of it shows the path.
    const bool anywhere = c.global_plan.facts.to_area;
    std::erase_if(s.targets.targets, [&](const ExplorationTarget& target) {
      const Eigen::Vector2d at = target.position.head<2>();
      return anywhere ? c.zones != nullptr && c.zones->distance(at) <= 0.0
                      : !c.frontiers.counts(at);
    });
  }
  s.more_target_lattices.clear();
  const double height = c.robot.depth_mount.T_BC.translation().z();
  for (const DepthSensor& sensor : sensors) {
    const CameraMount& mount = sensor.mount;
    const SensorLattice lattice = SensorLattice::around(
        camera_position(c, mount), camera_reach(c, mount), p.visibility_lattice, is_vertical(c),
        s.targets.positions(mount.T_BC.translation().z() - height), s.target_occlusion.max_range);
    if (&sensor == &sensors.front()) {
      s.target_lattice = lattice;
    } else {
      s.more_target_lattices.push_back(lattice);
    }
  }
}

void specify_cost_to_go(const StepContext& c, ProblemSpecification& s) {
  s.cost_to_go = c.retreat ? c.retreat : c.global_plan.cost_to_go;
}

void specify_weights(const StepContext& c, ProblemSpecification& s) {
  const PlannerParameters& p = c.parameters;
  const ModePolicy& rules = policy(c.mode);
  s.weights = p.weights;
  double& w_l = s.weights.visible_features;
  w_l = rests_on_features(c.belief) ? rules.features_weight * w_l : 0.0;
  s.weights.exploration_gain *= rules.exploration_weight;
  s.features.chance_weight = w_l > 0.0 ? p.w_c / w_l : 0.0;
  s.added_terms = p.terms;
  s.terms_left_out = p.terms_left_out;
}

}  // namespace

StepSpecification specify_problem(const StepContext& context) {
  StepSpecification made;
  specify_robot_and_horizon(context, made.problem);
  specify_obstacles(context, made.problem);
  made.num_mapped = specify_visible_features(context, made.problem);
  specify_exploration(context, made.problem);
  specify_cost_to_go(context, made.problem);
  specify_weights(context, made.problem);
  return made;
}

}  // namespace prospect
