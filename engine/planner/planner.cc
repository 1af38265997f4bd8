#include "engine/planner/planner.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/behaviour/mode_policy.h"
#include "engine/behaviour/monitors/following_monitor.h"
#include "engine/behaviour/monitors/localization_monitor.h"
#include "engine/behaviour/monitors/stuck_monitor.h"
#include "engine/features/feature_visibility_map.h"
#include "engine/features/landmark_selection.h"
#include "engine/features/local_texture.h"
#include "engine/features/tracked_calibration.h"
#include "engine/features/unseen_features.h"
#include "engine/frontiers/exploration_targets.h"
#include "engine/frontiers/goal_planner.h"
#include "engine/maps/surface_drift.h"
#include "engine/maps/usable_landmarks.h"
#include "engine/planner/feature_weight.h"
#include "engine/planner/retreat.h"
#include "engine/planner/seeds.h"
#include "engine/problem/admissible_inputs.h"
#include "engine/safety/certificate.h"
#include "engine/support/stopwatch.h"
#include "engine/support/worker_threads.h"
#include "engine/task/zone_map.h"
#include "models/body_transform.h"
#include "models/can_move.h"
#include "models/knobs.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

/// Violation [m and the like] up to which a candidate counts as feasible when candidates are
/// compared: the certificate, not this number, decides what may be executed.
constexpr double kFeasible = 1e-3;
// Points tracked, in N_min, with which a robot goes on exploring after a retreat.
constexpr double kEnoughToGoOn = 1.5;
// Share of a goal's tolerance within which the robot turns to its heading.
constexpr double kTurnsWithin = 0.6;

struct Candidate {
  std::string name;
  Eigen::VectorXd z;
  double cost = Problem::kRejectedCost;
  double violation = 0.0;
  std::optional<Result> result;  // of the solver, for polished ones
  double error = 0.0;            // that the cost may have: of a score
  double features = 0.0;         // of that term, not weighted

  bool operator<(const Candidate& other) const {
    const bool feasible = violation <= kFeasible;
    const bool other_feasible = other.violation <= kFeasible;
    if (feasible != other_feasible) return feasible;
    if (!feasible && violation != other.violation) return violation < other.violation;
    return cost < other.cost;
  }
};

std::shared_ptr<const ZoneMap> zone_map(const Zones& zones) {
  return zones.empty() ? nullptr : std::make_shared<const ZoneMap>(zones);
}

/// Makes what each step makes of the sensors and of parameters that are only passed on, so that
/// what is wrong with those is said now.
void check_parts(const RobotDescription& robot, const PlannerParameters& p) {
  validate(robot.stereo);
  validate(robot.stereo_mount);
  validate(robot.depth_mount);
  VisibleFeatures(
      std::make_shared<const VisibilityPrediction>(std::vector<Landmark>(), robot.stereo,
                                                   robot.stereo_mount, nullptr, p.visibility),
      p.features, nullptr);
}

Eigen::MatrixXd stage_inputs(const TrajectoryBatch& t) {
  const int nu = t.horizon.nu();
  Eigen::MatrixXd inputs(nu, t.horizon.N);
  for (int k = 0; k < t.horizon.N; ++k) {
    for (int j = 0; j < nu; ++j) inputs(j, k) = t.u(k, j, 0);
  }
  return inputs;
}

/// Why nothing can be planned from this belief; empty if something can.
std::string unusable(const Belief& belief) {
  if (!belief.octree || !belief.voxels || !belief.ground ||
      (!belief.landmarks && belief.localization_source == LocalizationSource::kVisualOdometry)) {
    return "the belief lacks a map";
  }
  if (!belief.pose.position.allFinite() || !std::isfinite(belief.pose.yaw)) {
    return "the pose is not finite";
  }
  if (belief.pose.position.cwiseAbs().maxCoeff() > kFarthest) return "the pose is out of range";
  if (!is_finite(belief.twist)) return "the velocity is not finite";
  if (belief.command && !is_finite(*belief.command)) return "the command in force is not finite";
  if (!std::isfinite(belief.stamp)) return "the stamp is not finite";
  return "";
}

}  // namespace

struct Planner::Impl {
  RobotDescription robot;
  PlannerParameters parameters;
  std::shared_ptr<const Solver> solver;
  std::vector<Certifier> certifiers;         // by Caution
  std::optional<Certifier> guard_certifier;  // as the guard will ask
  FrontierPlanner frontier_planner;
  std::optional<FeatureVisibilityMap> visibility_map;  // if the cost-to-go is weighted by it
  VerticalExtent slice{0.0, 0.0};                      // of the body, in W
  double reach = 0.0;  // how far the base can get within the horizon [m]
  std::unique_ptr<WorkerThreads> workers;
  bool shares_threads = false;  // the one solve of a step takes the option `threads`

  /// Of a robot whose localization does not rest on any: none known, none expected.
  const std::shared_ptr<const LandmarkMap> no_landmarks =
      std::make_shared<const LandmarkMap>(LandmarkMap{.landmarks = {}, .feature_density = 0.0});

  // From one step to the next.
  std::shared_ptr<const GlobalPlan> global_plan;
  CachedEvaluators parts;
  std::shared_ptr<const ProblemSpecification> specification;
  std::shared_ptr<const Problem> problem;
  std::vector<Seed> seeds;  // of the problem, best first
  std::size_t num_mapped =
      0;  // of the specification's landmarks; those after them are expected ones
  std::vector<Landmark> landmarks;
  Eigen::VectorXd visibility;
  Eigen::MatrixXd last_inputs;  // nu x N of the last plan
  double last_stamp = 0.0;
  std::shared_ptr<const ZoneMap> zones;  // null: none
  std::optional<GoalPlanner>
      goal_planner;           // of a task that leads to a place, from its first step on
  std::optional<Pose> start;  // of the first step
  double task_given_at = -std::numeric_limits<double>::infinity();  // first stamp with it [s]
  bool task_is_new = false;
  std::optional<double> last_step;  // [s]
  double away = 0.0;                // [s] in which the robot had other tasks than to explore
  RetreatTrail trail;
  LocalizationMonitor localization;
  FollowingMonitor following;
  StuckMonitor stuck;
  SurfaceDrift drift;
  Behaviour behaviour;
  ModeKind acting = ModeKind::kExplore;  // whose policy the plan of this step follows
  Facts facts;                           // of this step
  Caution caution = Caution::kNormal;    // in this step

  static PlannerParameters completed(const RobotDescription& r, PlannerParameters p) {
    check_knobs("planner", p);
    check_parts(r, p);
    p.frontier_planner = frontier_planner_options_for(r, p);
    const std::vector<std::string> wrong =
        faults(p.task, p.frontier_planner.traversability.zones.get(),
               p.frontier_planner.traversability.hard_radius);
    if (!wrong.empty()) throw std::invalid_argument("planner.task: " + wrong.front());
    p.behaviour.turn_away_time = M_PI / r.model->max_yaw_rate();
    return p;
  }

  Impl(RobotDescription r, PlannerParameters p, std::shared_ptr<const Solver> s)
      : robot(std::move(r)),
        parameters(completed(robot, std::move(p))),
        solver(std::move(s)),
        frontier_planner(parameters.frontier_planner) {
    if (!solver) throw std::invalid_argument("planner: no solver; expected one");
    workers = std::make_unique<WorkerThreads>(parameters.threads);
    const std::vector<OptionInfo> known = solver->options();
    shares_threads = solver->compares_starts() &&
                     std::any_of(known.begin(), known.end(),
                                 [](const OptionInfo& o) { return o.name == "threads"; });
    slice = robot.slice();
    zones = parameters.frontier_planner.traversability.zones;
    Certifier::Options options = Certifier::options_for(robot);
    options.zones = zones;
    options.drift_limit = parameters.drift_limit;
    options.unknown = parameters.unknown;
    for (const Caution kind : kCautions) {
      const CautionPolicy& rules = policy(kind);
      options.margin = rules.margin * parameters.certificate_margin;
      if (kind == Caution::kLost) options.margin = std::max(options.margin, parameters.lost_margin);
      options.held = rules.held;
      options.drift_margin = rules.drift_margin ? parameters.drift_margin : 0.0;
      certifiers.emplace_back(robot.shape, options);
    }
    options.margin = parameters.guard_margin();
    options.held = 0.0;
    options.unknown = UnknownPolicy::kFree;
    guard_certifier.emplace(robot.shape, options);
    reach = robot.model->max_speed() * parameters.N * parameters.dt;
    if (parameters.frontier_planner.cost_to_go.lambda > 0.0 && parameters.w_l > 0.0) {
      FeatureVisibilityMapOptions options;
      options.attenuation = parameters.feature_attenuation;
      visibility_map.emplace(options, robot, parameters.visibility);
    }
  }

  Plan plan(const Belief& given, const StopCondition& stop);
  void use_zones(const Zones& given);
  void use_task(const Task& task);
  /// GlobalPlan and facts of the task: frontiers, the way to a goal, or nothing to do.
  void plan_to_goal(const Belief& belief, bool pursues,
                    const std::optional<Eigen::Vector2d>& blocked);
  void stay(const Belief& belief);
  const Traversability& traversability() const {
    return goal_planner ? goal_planner->traversability() : frontier_planner.traversability();
  }
  std::vector<Seed> make_seeds_of(ModePolicy::Seeds wanted, const SeedContext& context) const;
  /// The facts that do not depend on the frontiers.
  void update_facts(const Belief& belief);
  const SurfaceDrift* minded_drift() const {
    return policy(caution).drift_in_cost ? &drift : nullptr;
  }
  static bool rests_on_features(const Belief& belief) {
    return belief.localization_source == LocalizationSource::kVisualOdometry;
  }
  double unseen_density(const Belief& belief) const {
    return parameters.feature_prior ? belief.landmarks->feature_density : 0.0;
  }
  /// texture: null where the localization does not rest on features.
  std::shared_ptr<const ProblemSpecification> make_specification(const Belief& belief,
                                                                 const LocalTexture* texture);
  /// Lowers the weight of the features, in the problem and in the costs of its measured seeds, to
  /// where going on is better than waiting (feature_weight.h).
  void bound_features(std::vector<Candidate>& candidates);
  void calibrate(const Belief& belief, const Eigen::Vector3d& camera,
                 ProblemSpecification& r) const;
  std::vector<Candidate> measure(std::vector<Candidate> candidates, Evaluate what) const;
  void polish(std::vector<Candidate>& candidates, const StopCondition& stop, Plan& plan) const;
  /// The solver's result from one start; of quality kNone if there is none.
  Result solve(const WarmStart& warm, int evaluations, const StopCondition& stop) const;
  void execute_best(const Belief& belief, const std::vector<Candidate>& candidates,
                    Plan& plan) const;
  void fill(const TrajectoryBatch& t, int committed, Plan& plan) const;
  Plan stopping_plan(const Belief& belief, const std::string& why) const;
};

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
  constexpr double kFarLook = 50.0;
  options.frontiers.sensor_range = std::min(robot.depth.max_range, kFarLook);
  options.frontiers.range_margin =
      std::min(options.frontiers.range_margin, 0.25 * options.frontiers.sensor_range);
  options.worth.sensor_range = options.frontiers.sensor_range;
  options.worth.sensor_fov = std::min(robot.depth.horizontal_fov, 2.0 * M_PI);
  options.traversability.facing = 0.5 * options.worth.sensor_fov;
  // All round there is no side to keep away from; a narrow field is not all margin.
  const bool all_round = options.worth.sensor_fov > 2.0 * M_PI - options.worth.fov_margin;
  options.worth.fov_margin =
      all_round ? 0.0 : std::min(options.worth.fov_margin, options.worth.sensor_fov / 8.0);
  options.traversability.zones = zone_map(parameters.zones);
  options.traversability.top_speed = robot.model->max_speed();
  options.area = parameters.task.area;
  options.cost_to_go.v_max = robot.model->max_speed();
  options.turn_price = robot.model->max_speed() / robot.model->max_yaw_rate();
  options.cost_to_go.features_required = parameters.features.N_req;
  return options;
}

Guard guard_for(const RobotDescription& robot, const PlannerParameters& parameters,
                Guard::Options options) {
  if (!robot.model) throw std::invalid_argument("guard: no motion model; expected one");
  Certifier::Options certificate = Certifier::options_for(robot);
  certificate.margin = parameters.guard_margin();
  certificate.unknown = UnknownPolicy::kFree;
  certificate.zones = zone_map(parameters.zones);
  options.max_step = std::max(options.max_step, parameters.dt);
  return Guard(robot.model, robot.shape, certificate, options);
}

void Planner::Impl::use_zones(const Zones& given) {
  parameters.zones = given;
  zones = zone_map(given);
  for (Certifier& certifier : certifiers) certifier.set_zones(zones);
  guard_certifier->set_zones(zones);
  parameters.frontier_planner.traversability.zones = zones;
  frontier_planner = FrontierPlanner(parameters.frontier_planner);
  goal_planner.reset();
}

void Planner::Impl::use_task(const Task& task) {
  const bool other_area =
      task.kind == TaskKind::kExplore && task.area != parameters.frontier_planner.area;
  parameters.task = task;
  task_is_new = true;
  goal_planner.reset();
  if (!other_area) return;
  parameters.frontier_planner.area = task.area;
  frontier_planner = FrontierPlanner(parameters.frontier_planner);
}

void Planner::Impl::plan_to_goal(const Belief& belief, bool pursues,
                                 const std::optional<Eigen::Vector2d>& blocked) {
  if (!goal_planner) {
    const bool back = parameters.task.kind == TaskKind::kReturn;
    Goal goal = parameters.task.goal;
    if (back) {
      goal.position = start->position.head<2>();
      goal.yaw = start->yaw;
    }
    goal_planner.emplace(GoalPlannerOptions{parameters.frontier_planner.traversability,
                                            parameters.frontier_planner.cost_to_go},
                         goal,
                         back ? parameters.return_unknown_price : parameters.goal_unknown_price);
  }
  global_plan = goal_planner->update(*belief.ground, belief.pose, belief.stamp, pursues, blocked);
  facts.goal = goal_planner->facts();
}

void Planner::Impl::stay(const Belief& belief) {
  auto nothing = std::make_shared<GlobalPlan>();
  const double r = belief.ground->frame().resolution;
  nothing->map_revision = belief.ground->revision();
  nothing->stamp = belief.stamp;
  nothing->cost_to_go = std::make_shared<const CostToGo>();
  nothing->explored_area = r * r * (belief.ground->free_cells() + belief.ground->occupied_cells());
  global_plan = std::move(nothing);
}

std::vector<Seed> Planner::Impl::make_seeds_of(ModePolicy::Seeds wanted,
                                               const SeedContext& context) const {
  switch (wanted) {
    case ModePolicy::Seeds::kAll:
      return make_seeds(*problem, context);
    case ModePolicy::Seeds::kApproach:
    case ModePolicy::Seeds::kTurn:
      return make_approach_seeds(*problem, context);
    case ModePolicy::Seeds::kArrive:
      return make_arrival_seeds(*problem, context,
                                kTurnsWithin * parameters.task.goal.position_tolerance);
    case ModePolicy::Seeds::kStop:
      break;
  }
  return make_stop_seeds(*problem);
}

void Planner::Impl::update_facts(const Belief& belief) {
  localization.update(belief.stamp, belief.localization);
  const Eigen::Vector2d position = belief.pose.position.head<2>();
  facts = {};
  facts.stamp = belief.stamp;
  facts.localization = belief.localization;
  facts.rests_on_features = rests_on_features(belief);
  facts.tracked = belief.tracked_features;
  facts.enough_features = belief.localization == Localization::kOk &&
                          (!rests_on_features(belief) ||
                           belief.tracked_features >= kEnoughToGoOn * parameters.features.N_min);
  facts.lost_for = localization.lost_for();
  facts.not_following_at = following.noticed_at();
  facts.task = parameters.task.kind;
  facts.task_given_at = task_given_at;
  if (facts.enough_features) trail.note(position, belief.tracked_features);
  if (!trail.places().empty()) {
    facts.tracked_at_retreat = trail.tracked_at_newest();
    facts.retreat_distance = (trail.places().back() - position).norm();
  }
}

/// What is in view now counts as it is tracked.
void Planner::Impl::calibrate(const Belief& belief, const Eigen::Vector3d& camera,
                              ProblemSpecification& r) const {
  Eigen::VectorXd visible =
      VisibilityPrediction(r.landmarks, robot.stereo, robot.stereo_mount, nullptr, r.visibility)
          .probabilities(belief.pose);
  for (std::size_t i = 0; i < r.landmarks.size(); ++i) {
    double& pi = visible[static_cast<Eigen::Index>(i)];
    if (!(pi > 0.0)) continue;
    const VoxelGrid::Ray ray =
        belief.voxels->cast(camera, r.landmarks[i].position, r.landmark_occlusion.trim);
    pi *= ray.blocked ? 0.0 : std::exp(-r.landmark_occlusion.attenuation * ray.unknown_length);
  }
  calibrate_to_tracked(r.landmarks, visible, belief.tracked_features);
}

std::shared_ptr<const ProblemSpecification> Planner::Impl::make_specification(
    const Belief& belief, const LocalTexture* texture) {
  const PlannerParameters& p = parameters;
  const MotionModel& model = *robot.model;
  const InputLimits& limits = model.limits();
  auto r = std::make_shared<ProblemSpecification>();
  r->robot = robot;
  r->x0 = model.state(belief.pose, belief.twist);
  r->u_previous = model.input(belief.command.value_or(belief.twist))
                      .cwiseMax(limits.lower)
                      .cwiseMin(limits.upper);
  r->N = p.N;
  r->dt = p.dt;
  r->M = p.M;
  Twist desired;
  desired.linear.x() = p.desired_speed * model.max_speed();
  r->desired_input = model.input(desired);
  r->voxels = belief.voxels;
  r->ground = belief.ground;

  const bool vertical = model.pose_layout().pz >= 0;
  const double radius = circumscribed_radius(robot.shape);
  r->clearance_center = belief.pose.position;
  r->clearance_field.vertical = vertical;
  r->clearance_field.slice = slice;
  // It is asked where the robot would come to rest, too.
  const double to_stop = model.max_speed() * model.max_speed() / (2.0 * model.max_deceleration());
  r->clearance_field.reach = reach + to_stop + 1.0;
  r->clearance_field.cutoff = std::max(0.8, radius + p.d_des + p.drift_margin + 0.2);
  const SurfaceDrift* minded = minded_drift();
  const double drifted =
      minded == nullptr
          ? 0.0
          : std::min(p.drift_margin, minded->sigma_near(belief.pose.position.head<2>(),
                                                        radius + p.d_des + p.drift_margin));
  r->d_safe = p.d_safe + drifted;
  r->d_des = p.d_des + drifted;
  r->clearance.d_safe = policy(caution).hard_clearance ? p.d_safe : 0.0;
  r->clearance.floor = std::min(r->clearance.floor, r->clearance.d_safe);
  r->unknown = p.unknown;
  r->unknown_d_safe = p.d_safe;
  r->zones = zones;

  const Eigen::Isometry3d T_WB = body_transform(belief.pose);
  const double stereo_offset = robot.stereo_mount.T_BC.translation().head<2>().norm();
  const Eigen::Vector3d stereo_camera = T_WB * robot.stereo_mount.T_BC.translation();
  r->landmark_lattice =
      SensorLattice::around(stereo_camera, reach + stereo_offset, p.visibility_lattice, vertical);
  r->landmark_occlusion.attenuation = p.feature_attenuation;
  r->landmark_occlusion.trim = 1.5 * belief.voxels->resolution();
  r->landmark_occlusion.max_range = p.visibility.r_max + 1.0;
  r->target_occlusion = r->landmark_occlusion;
  r->target_occlusion.attenuation = p.unknown_attenuation;
  r->target_occlusion.max_range = robot.depth.max_range + 1.0;
  if (!p.feature_occlusion) r->landmark_occlusion.trim = r->landmark_occlusion.max_range;
  r->visibility = p.visibility;
  UnseenFeatureOptions unseen;
  unseen.density = unseen_density(belief);
  unseen.range = reach + p.visibility.r_max;
  unseen.height = stereo_camera.z();
  unseen.max_blocks = p.max_landmarks / 4;
  unseen.image_cell = belief.landmarks->image_cell;
  const std::vector<Landmark> expected =
      unseen_features(*belief.ground, belief.pose, unseen, texture);
  r->landmarks =
      select_landmarks(*belief.landmarks, belief.pose, reach + stereo_offset,
                       p.max_landmarks - static_cast<int>(expected.size()), p.visibility);
  num_mapped = r->landmarks.size();
  r->landmarks.insert(r->landmarks.end(), expected.begin(), expected.end());
  if (!p.feature_covariance) {
    OdometryNoise& noise = r->visibility.odometry;
    noise.position_per_metre = noise.position_per_radian = 0.0;
    noise.yaw_per_metre = noise.yaw_per_radian = 0.0;
    for (Landmark& landmark : r->landmarks) landmark.covariance.setZero();
  }
  if (belief.localization != Localization::kLost) calibrate(belief, stereo_camera, *r);

  std::vector<Cell> frontier_cells;
  for (std::size_t i = 0; i < global_plan->frontiers.size(); ++i) {
    const Frontier& f = global_plan->frontiers[i];
    const bool chosen = global_plan->target && global_plan->target->frontier == static_cast<int>(i);
    if (f.active && (chosen || !p.target_frontier_only)) {
      frontier_cells.insert(frontier_cells.end(), f.cells.begin(), f.cells.end());
    }
  }
  ExplorationTargetOptions target_options;
  target_options.max_targets = p.max_targets;
  if (global_plan->target) target_options.led_to = global_plan->target->looks_at;
  r->targets =
      exploration_targets(belief, frontier_cells, robot.depth, robot.depth_mount, target_options);
  if (zones != nullptr || p.frontier_planner.area) {
    std::erase_if(r->targets.targets, [&](const ExplorationTarget& target) {
      return !frontier_planner.counts(target.position.head<2>());
    });
  }
  const double depth_offset = robot.depth_mount.T_BC.translation().head<2>().norm();
  r->target_lattice = SensorLattice::around(T_WB * robot.depth_mount.T_BC.translation(),
                                            reach + depth_offset, p.visibility_lattice, vertical);

  const ModePolicy& rules = policy(acting);
  const double w_e = rules.exploration_weight * p.w_e;
  const double w_l = rests_on_features(belief) ? rules.features_weight * p.w_l : 0.0;
  r->cost_to_go = global_plan->cost_to_go;
  if (rules.cost_to_go == ModePolicy::CostToGo::kRetreat) {
    const auto retreat =
        trail.cost_to_go(traversability(), belief.pose.position.head<2>(), model.max_speed());
    if (retreat) r->cost_to_go = retreat;
  }
  r->features = p.features;
  if (rules.count_features) {
    r->features.criterion = VisibilityCriterion::kCount;
    r->features.N_req = std::max(p.features.N_req, 2.0 * kEnoughToGoOn * p.features.N_min);
  }
  r->features.rho = 0.0;
  r->features.chance_weight = w_l > 0.0 ? p.w_c / w_l : 0.0;
  r->weights = {p.w_u, p.w_du, p.w_o, w_l, w_e, p.w_T, p.w_h};
  return r;
}

void Planner::Impl::bound_features(std::vector<Candidate>& candidates) {
  const double most = specification->weights.visible_features;
  const auto standing = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) {
    return c.name == "stop" && c.violation <= kFeasible;
  });
  if (most <= 0.0 || standing == candidates.end()) return;
  std::vector<WeighedCandidate> feasible;
  for (const Candidate& c : candidates) {
    if (c.violation <= kFeasible) feasible.push_back({c.cost - most * c.features, c.features});
  }
  const double weight = feature_weight(feasible, standing->cost - most * standing->features, most);
  if (weight >= most) return;
  auto bounded = std::make_shared<ProblemSpecification>(*specification);
  bounded->weights.visible_features = weight;
  specification = bounded;
  problem = assemble_problem(*specification, parts);
  for (Candidate& c : candidates) c.cost -= (most - weight) * c.features;
  std::stable_sort(candidates.begin(), candidates.end());
}

/// Those that can be evaluated, best first. Scores choose among seeds, the exact value tells what a
/// plan costs.
std::vector<Candidate> Planner::Impl::measure(std::vector<Candidate> candidates,
                                              Evaluate what) const {
  if (candidates.empty()) return candidates;
  Eigen::MatrixXd X(problem->num_variables(), static_cast<Eigen::Index>(candidates.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    X.col(static_cast<Eigen::Index>(i)) = candidates[i].z;
  }
  // Whole registers of floats, several to each thread, as the first ones have rays to cast.
  const Eigen::Index portion = parameters.threads > 1 ? 8 : X.cols();
  const auto portions = static_cast<int>((X.cols() + portion - 1) / portion);
  std::vector<Evaluation> evaluations(static_cast<std::size_t>(portions));
  const auto evaluate_all = [&] {
    std::atomic<bool> all_valid = true;
    workers->run(portions, [&](int k) {
      Workspace workspace = problem->make_workspace();
      const Eigen::Index first = k * portion;
      if (!problem->evaluate(X.middleCols(first, std::min(portion, X.cols() - first)), what,
                             workspace, evaluations[static_cast<std::size_t>(k)])) {
        all_valid = false;
      }
    });
    return all_valid.load();
  };
  if (!evaluate_all() && what == Evaluate::kScore) {
    // Single precision may overflow where the exact value does not.
    what = Evaluate::kValue;
    evaluate_all();
  }
  const auto& terms = problem->definition().terms;
  const auto features = std::find_if(
      terms.begin(), terms.end(), [&](const auto& t) { return t.term == parts.visible_features; });
  std::vector<Candidate> scored;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const Evaluation& evaluation = evaluations[static_cast<std::size_t>(at / portion)];
    const Eigen::Index b = at % portion;
    if (!evaluation.valid[b]) continue;
    candidates[i].cost = evaluation.cost[b];
    candidates[i].violation = violation(evaluation.constraints.col(b));
    candidates[i].error = evaluation.cost_error[b];
    candidates[i].features = evaluation.terms(features - terms.begin(), b);
    scored.push_back(std::move(candidates[i]));
  }
  std::stable_sort(scored.begin(), scored.end());
  return scored;
}

Result Planner::Impl::solve(const WarmStart& warm, int evaluations,
                            const StopCondition& stop) const {
  Options options = parameters.solver_options;
  options.try_emplace("max_evaluations", evaluations);
  if (shares_threads) options.try_emplace("threads", parameters.threads);
  Result result;
  try {
    result = solver->solve(*problem, warm, options, stop);
  } catch (const std::exception& e) {
    result.detail = std::string("the solver threw: ") + e.what();
  } catch (...) {
    result.detail = "the solver threw";
  }
  return result;
}

void Planner::Impl::polish(std::vector<Candidate>& candidates, const StopCondition& stop,
                           Plan& plan) const {
  std::vector<Candidate> polished;
  const auto take = [&](const Candidate& seed, Result result) {
    plan.counters.cost_evaluations += result.counters.cost_evaluations;
    plan.counters.gradient_evaluations += result.counters.gradient_evaluations;
    plan.counters.iterations += result.counters.iterations;
    plan.stop = result.stop;
    if (result.stop == StopReason::kError) plan.detail = result.detail;
    if (result.quality == Quality::kNone || result.x.size() != problem->num_variables() ||
        !result.x.allFinite()) {
      return;
    }
    Candidate c{seed.name, admissible_inputs(*problem, result.x), result.cost, result.violation,
                std::move(result)};
    polished.push_back(std::move(c));
  };

  if (solver->compares_starts() && !candidates.empty() && parameters.polished > 0) {
    const auto others = static_cast<Eigen::Index>(candidates.size()) - 1;
    WarmStart warm;
    warm.x = candidates.front().z;
    warm.seeds.resize(warm.x.size(), others);
    for (Eigen::Index i = 0; i < others; ++i) {
      warm.seeds.col(i) = candidates[static_cast<std::size_t>(i) + 1].z;
    }
    // It scores the seeds itself: those evaluations are no polish.
    take(candidates.front(),
         solve(warm,
               parameters.polished * parameters.polish_evaluations + static_cast<int>(others) + 1,
               stop));
  } else {
    // Basins apart: seeds that end near each other usually polish to the same plan.
    std::vector<const Candidate*> chosen;
    std::vector<Pose> ends;
    for (const Candidate& seed : candidates) {
      if (static_cast<int>(chosen.size()) >= parameters.polished) break;
      const TrajectoryBatch t = problem->rollout(seed.z);
      const Pose end = t.pose(parameters.N, 0);
      const bool known_basin = std::any_of(ends.begin(), ends.end(), [&](const Pose& other) {
        return (other.position - end.position).norm() < 0.4 &&
               std::abs(std::remainder(other.yaw - end.yaw, 2.0 * M_PI)) < 0.5;
      });
      if (known_basin) continue;
      chosen.push_back(&seed);
      ends.push_back(end);
    }
    const StopCondition asked = one_at_a_time(stop);
    std::vector<std::optional<Result>> results(chosen.size());
    workers->run(static_cast<int>(chosen.size()), [&](int k) {
      const auto at = static_cast<std::size_t>(k);
      if (asked() != StopRequest::kNone) return;
      WarmStart warm;
      warm.x = chosen[at]->z;
      results[at] = solve(warm, parameters.polish_evaluations, asked);
    });
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      if (results[k]) take(*chosen[k], std::move(*results[k]));
    }
  }
  // Measured again: what is compared is what would be driven, whatever the solver says of it.
  polished = measure(std::move(polished), Evaluate::kValue);
  candidates.insert(candidates.end(), std::make_move_iterator(polished.begin()),
                    std::make_move_iterator(polished.end()));
  std::stable_sort(candidates.begin(), candidates.end());
  // So are the seeds that may be better than all that were: the order of what comes first is that
  // of exact costs.
  const auto known = std::find_if(candidates.begin(), candidates.end(),
                                  [](const Candidate& c) { return c.error == 0.0; });
  std::optional<Candidate> best;
  if (known != candidates.end()) best = *known;
  const auto open = [&](const Candidate& c) {
    if (c.error == 0.0) return false;
    Candidate least;
    least.cost = c.cost - c.error;
    least.violation = c.violation;
    return !best || !(*best < least);
  };
  std::vector<Candidate> leading;
  for (const Candidate& c : candidates) {
    if (open(c)) leading.push_back(c);
  }
  leading = measure(std::move(leading), Evaluate::kValue);
  std::erase_if(candidates, open);
  candidates.insert(candidates.begin(), std::make_move_iterator(leading.begin()),
                    std::make_move_iterator(leading.end()));
  std::stable_sort(candidates.begin(), candidates.end());
}

void Planner::Impl::fill(const TrajectoryBatch& t, int committed, Plan& plan) const {
  const int N = t.horizon.N;
  const int nx = t.horizon.nx();
  const int nu = t.horizon.nu();
  plan.dt = t.horizon.dt;
  plan.committed = committed;
  plan.states.clear();
  plan.inputs.clear();
  plan.commands.clear();
  for (int k = 0; k <= N; ++k) {
    plan.states.emplace_back(Eigen::Map<const Eigen::VectorXd>(t.states.data() + k * nx, nx));
    if (k < N) {
      plan.inputs.emplace_back(Eigen::Map<const Eigen::VectorXd>(t.inputs.data() + k * nu, nu));
    }
  }
  for (int k = 0; k < N; ++k) {
    const auto i = static_cast<std::size_t>(k);
    plan.commands.push_back(robot.model->twist(plan.states[i + 1], plan.inputs[i]));
  }
}

void Planner::Impl::execute_best(const Belief& belief, const std::vector<Candidate>& candidates,
                                 Plan& plan) const {
  constexpr int kAttempts = 10;
  constexpr std::size_t kReported = 5;
  const int committed =
      std::min(parameters.N,
               std::max(1, static_cast<int>(std::lround(parameters.committed / parameters.dt))));
  const ProblemDefinition& d = problem->definition();
  const auto report = [&](const Candidate& c, const std::string& verdict, bool always) {
    if (plan.candidates.size() >= kReported && !always) return;
    plan.candidates.push_back({c.name, c.result.has_value(), c.cost, c.violation, c.z, verdict});
  };
  int attempts = 0;
  for (const Candidate& c : candidates) {
    if (plan.certified) {
      report(c, "not tried", false);
      continue;
    }
    // "stop" is worth a try whatever its rank.
    if (attempts >= kAttempts && c.name != "stop") {
      report(c, "not tried", false);
      continue;
    }
    ++attempts;
    const TrajectoryBatch t = problem->rollout(c.z);
    const Eigen::MatrixXd inputs = stage_inputs(t).leftCols(committed);
    Certificate certificate = certifiers[static_cast<std::size_t>(caution)].certify(
        belief, *robot.model, d.x0, d.u_previous, inputs, d.dt,
        policy(caution).drift ? &drift : nullptr);
    // A start within the larger margin is checked with less of it, and may come closer to an
    // obstacle than the guard allows later on: without the guard's margin the two would disagree
    // for ever.
    if (certificate.ok()) {
      const Certificate guard =
          guard_certifier->certify(belief, *robot.model, d.x0, d.u_previous, inputs, d.dt);
      if (!guard.ok()) certificate = guard;
    }
    if (!certificate.ok()) {
      if (plan.certificate.empty()) plan.certificate = certificate.detail;
      report(c, certificate.detail, false);
      continue;
    }
    report(c, "executed", true);
    fill(t, committed, plan);
    plan.kind = c.result ? PlanKind::kOptimised : PlanKind::kSeed;
    plan.certified = true;
    plan.certificate = certificate.detail;
    plan.seed = c.name;
    plan.quality = c.result
                       ? c.result->quality
                       : (c.violation <= kFeasible ? Quality::kFeasible : Quality::kInfeasible);
    plan.explanation = problem->explain(c.z);
    plan.visible = parts.visible_features->visible(t, 0);
  }
  if (plan.certified) return;
  const std::string why = "no candidate could be certified: " + plan.certificate;
  const Plan halt = stopping_plan(belief, why);
  plan.kind = halt.kind;
  plan.dt = halt.dt;
  plan.states = halt.states;
  plan.inputs = halt.inputs;
  plan.commands = halt.commands;
  plan.committed = halt.committed;
  plan.certified = halt.certified;
  plan.detail = why;
  plan.why += " It brakes: " + why + '.';
}

Plan Planner::Impl::stopping_plan(const Belief& belief, const std::string& why) const {
  Plan plan;
  plan.kind = PlanKind::kStoppingTail;
  plan.stamp = belief.stamp;
  plan.dt = parameters.dt;
  plan.detail = why;
  plan.task = parameters.task.kind;
  plan.mode = behaviour.mode;
  plan.caution = caution;
  plan.why = "Brakes: " + why + '.';
  const MotionModel& model = *robot.model;
  // Braking does not depend on where the robot is, so a lost pose does not keep it from braking.
  const bool located = belief.pose.position.allFinite() && std::isfinite(belief.pose.yaw);
  const Twist twist = limited_twist(model, belief.command.value_or(belief.twist));
  Eigen::VectorXd x = model.state(located ? belief.pose : Pose(), twist);
  const Eigen::MatrixXd tail = stopping_tail(model, x, model.input(twist), parameters.dt);
  plan.states.push_back(x);
  Eigen::VectorXd next(model.nx());
  for (Eigen::Index k = 0; k < tail.cols(); ++k) {
    model.step(x, tail.col(k), parameters.dt, next);
    plan.commands.push_back(limited_twist(model, model.twist(next, tail.col(k))));
    plan.inputs.emplace_back(tail.col(k));
    x.swap(next);
    plan.states.push_back(x);
  }
  plan.committed = static_cast<int>(tail.cols());
  plan.certified = false;
  return plan;
}

Plan Planner::Impl::plan(const Belief& given, const StopCondition& outer) {
  Stopwatch total, watch;
  const StopCondition stop =
      parameters.deadline > 0.0 ? (deadline(parameters.deadline) || outer) : outer;
  Plan plan;
  plan.stamp = given.stamp;
  problem = nullptr;
  specification = nullptr;
  seeds.clear();
  if (const std::string why = unusable(given); !why.empty()) {
    return stopping_plan(given, "planning is impossible: " + why);
  }
  Belief belief = given;
  if (rests_on_features(given)) {
    UsableLandmarks usable = usable_landmarks(given.landmarks);
    plan.landmarks_dropped = usable.dropped;
    plan.landmark_fault = std::move(usable.fault);
    belief.landmarks = std::move(usable.map);
  } else {
    belief.landmarks = no_landmarks;
  }
  plan.solver = solver->name();

  // The direction in which the robot does not get on: it turns away from there.
  std::optional<Eigen::Vector2d> blocked;
  if (belief.command && belief.localization != Localization::kLost) {
    blocked = following.update(belief.stamp, belief.pose, *belief.command);
  } else {
    following.reset();
  }
  if (!start) start = belief.pose;
  if (task_is_new) task_given_at = belief.stamp;
  task_is_new = false;
  const TaskKind told = parameters.task.kind;
  if (told != TaskKind::kExplore && last_step) away += std::max(0.0, belief.stamp - *last_step);
  last_step = belief.stamp;
  update_facts(belief);
  const bool lost = belief.localization == Localization::kLost;
  // What comes before the frontiers in the table tells whether it pursues its target.
  const ModeKind before_frontiers = decide(behaviour, facts, parameters.behaviour).mode.kind;
  const bool pursues = policy(before_frontiers).pursues;
  facts.stuck = stuck.update(belief.stamp, belief.pose.position.head<2>(), !lost && pursues);
  // Without a landmark all ways are alike.
  const bool looks_out =
      visibility_map && !belief.landmarks->landmarks.empty() && told == TaskKind::kExplore;
  std::optional<LocalTexture> seen_texture;
  if (rests_on_features(belief)) {
    seen_texture.emplace(*belief.ground, *belief.landmarks, belief.pose.position.head<2>());
  }
  const LocalTexture* texture = seen_texture ? &*seen_texture : nullptr;
  if (looks_out) visibility_map->update(belief, unseen_density(belief), texture, workers.get());
  if (told == TaskKind::kExplore) {
    global_plan = frontier_planner.update(*belief.ground, belief.pose, belief.stamp - away,
                                          {.looked = !lost,
                                           .pursued = pursues,
                                           .got_lost = localization.got_lost(),
                                           .blocked = blocked},
                                          looks_out ? &*visibility_map : nullptr);
    facts.frontiers = global_plan->facts;
  } else if (has_goal(told)) {
    plan_to_goal(belief, pursues, blocked);
    plan.goal = goal_planner->goal();
  } else {
    stay(belief);
  }
  behaviour = decide(behaviour, facts, parameters.behaviour);
  acting = behaviour.mode.kind;
  // A robot that is done has no target any more, but a retreat or a turn goes on.
  if (acting == ModeKind::kDone) {
    acting = told == TaskKind::kExplore ? before_frontiers : ModeKind::kHold;
  }
  plan.task = told;
  caution = caution_for(facts, parameters.lost_margin > 0.0);
  plan.mode = behaviour.mode;
  plan.caution = caution;
  plan.why = describe(behaviour.mode, facts);
  plan.has_active_frontier = global_plan->target.has_value();
  plan.times.frontier_planner = watch.lap();
  drift.update(belief, robot);
  specification = make_specification(belief, texture);
  landmarks.assign(specification->landmarks.begin(),
                   specification->landmarks.begin() + static_cast<std::ptrdiff_t>(num_mapped));
  plan.times.views = watch.lap();
  update_clearance(*specification, parts);
  plan.times.clearance = watch.lap();
  update_views(*specification, parts);
  visibility =
      parts.prediction->probabilities(belief.pose).head(static_cast<Eigen::Index>(num_mapped));
  plan.times.views += watch.lap();
  problem = assemble_problem(*specification, parts);

  SeedContext context;
  context.cost_to_go = global_plan->cost_to_go.get();
  context.target = global_plan->target;
  context.clearance = parts.occupied.get();
  std::optional<BodyClearance> known;
  if (parameters.unknown == UnknownPolicy::kBraking) {
    known.emplace(parts.known, robot.shape);
    context.known = &*known;
    context.known_margin = parameters.d_safe;
  }
  context.backwards = parameters.frontier_planner.traversability.body.has_value() &&
                      can_move(*robot.model, -Eigen::Vector2d::UnitX());
  if (last_inputs.cols() > 0) {
    const auto passed =
        static_cast<Eigen::Index>(std::lround((belief.stamp - last_stamp) / parameters.dt));
    if (passed >= 0 && passed < last_inputs.cols()) {
      context.previous = last_inputs.rightCols(last_inputs.cols() - passed);
    }
  }
  const ModePolicy::Seeds wanted = policy(acting).seeds;
  if (wanted == ModePolicy::Seeds::kTurn) context.target.reset();
  const bool in_order = wanted != ModePolicy::Seeds::kAll;
  const std::vector<Seed> made = make_seeds_of(wanted, context);
  std::vector<Candidate> candidates;
  for (const Seed& seed : made) candidates.push_back({seed.name, seed.z, 0.0, 0.0, std::nullopt});
  candidates = measure(std::move(candidates), Evaluate::kScore);
  plan.seeds_scored = static_cast<int>(made.size());
  if (acting == ModeKind::kExplore && !lost) bound_features(candidates);
  plan.features_weight = specification->weights.visible_features;
  for (const Candidate& c : candidates) seeds.push_back({c.name, c.z});
  plan.counters.cost_evaluations = plan.seeds_scored;
  plan.times.seeds = watch.lap();
  if (in_order) {
    // They are what the optimisation did not find: the first certified one is taken.
    const auto rank = [&](const Candidate& c) {
      const auto at =
          std::find_if(made.begin(), made.end(), [&](const Seed& s) { return s.name == c.name; });
      return std::distance(made.begin(), at);
    };
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
  } else {
    polish(candidates, stop, plan);
  }
  plan.times.polish = watch.lap();
  execute_best(belief, candidates, plan);
  plan.times.certify = watch.lap();

  last_stamp = belief.stamp;
  last_inputs.resize(robot.model->nu(), static_cast<Eigen::Index>(plan.inputs.size()));
  for (std::size_t k = 0; k < plan.inputs.size(); ++k) {
    last_inputs.col(static_cast<Eigen::Index>(k)) = plan.inputs[k];
  }
  plan.times.total = total.lap();
  return plan;
}

Planner::Planner(RobotDescription robot, PlannerParameters parameters,
                 std::shared_ptr<const Solver> solver)
    : impl_(std::make_unique<Impl>(std::move(robot), std::move(parameters), std::move(solver))) {}
Planner::~Planner() = default;

Plan Planner::plan(const Belief& belief, const StopCondition& stop) {
  try {
    return impl_->plan(belief, stop);
  } catch (const std::exception& e) {
    return impl_->stopping_plan(belief, std::string("planning failed: ") + e.what());
  } catch (...) {
    return impl_->stopping_plan(belief, "planning failed");
  }
}

std::string Planner::set_task(const Task& task) {
  const std::vector<std::string> wrong = faults(
      task, impl_->zones.get(), impl_->parameters.frontier_planner.traversability.hard_radius);
  if (!wrong.empty()) return wrong.front();
  impl_->use_task(task);
  return "";
}
const Task& Planner::task() const { return impl_->parameters.task; }
std::string Planner::set_zones(const Zones& zones) {
  const std::vector<std::string> wrong = faults(zones);
  if (!wrong.empty()) return wrong.front();
  impl_->use_zones(zones);
  return "";
}
std::shared_ptr<const GlobalPlan> Planner::global_plan() const { return impl_->global_plan; }
std::shared_ptr<const Problem> Planner::problem() const { return impl_->problem; }
std::shared_ptr<const ProblemSpecification> Planner::specification() const {
  return impl_->specification;
}
const std::vector<Seed>& Planner::seeds() const { return impl_->seeds; }
const std::vector<Landmark>& Planner::landmarks() const { return impl_->landmarks; }
const Eigen::VectorXd& Planner::landmark_visibility() const { return impl_->visibility; }
const PlannerParameters& Planner::parameters() const { return impl_->parameters; }
const RobotDescription& Planner::robot() const { return impl_->robot; }
Guard Planner::make_guard(const Guard::Options& options) const {
  return guard_for(impl_->robot, impl_->parameters, options);
}

}  // namespace prospect
