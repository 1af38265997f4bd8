// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/behaviour/mode_policy.h"
#include "engine/maps/correction.h"
#include "engine/maps/surface_drift.h"
#include "engine/planner/added_terms.h"
#include "engine/planner/candidate_evaluation.h"
#include "engine/planner/candidate_polish.h"
#include "engine/planner/feature_weight.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/planner/global_planner.h"
#include "engine/planner/plan_certifier.h"
#include "engine/planner/plan_choice.h"
#include "engine/planner/planner_fit.h"
#include "engine/planner/planner_guard.h"
#include "engine/planner/seeds.h"
#include "engine/planner/step_landmarks.h"
#include "engine/planner/step_monitors.h"
#include "engine/planner/step_specification.h"
#include "engine/planner/stopping_plan.h"
#include "engine/support/resumed.h"
#include "engine/support/stopwatch.h"
#include "engine/support/worker_threads.h"
#include "engine/task/moved.h"
#include "engine/task/zone_map.h"
#include "engine/terms/builtin_terms.h"
#include "models/can_move.h"
#include "models/depth_sensors.h"
#include "models/formatted.h"
#include "models/knobs.h"
#include "models/limited_twist.h"
#include "models/parameter_check.h"

namespace prospect {
namespace {

// Share of a goal's tolerance within which the robot turns to its heading.
constexpr double kTurnsWithin = 0.6;

/// Makes what each step makes of the sensors and of parameters that are only passed on, so that
/// what is wrong with those is said now.
void check_sensors(const RobotDescription& robot, const PlannerParameters& p) {
  validate(robot.stereo);
  validate(robot.stereo_mount);
  validate("planner", robot.depth_sensors());
  VisibleFeatures(
      std::make_shared<const VisibilityPrediction>(std::vector<Landmark>(), robot.stereo,
                                                   robot.stereo_mount, nullptr, p.visibility),
      p.features, nullptr);
}

/// Checked, with what follows from the robot filled in.
PlannerParameters completed(const RobotDescription& robot, PlannerParameters p) {
  check_knobs("planner", p);
  check_sensors(robot, p);
  check_parameter(p.map_resolution >= 0.0 && p.map_resolution <= 10.0, "planner", "map_resolution",
                  p.map_resolution, "0, or a number up to 10 m");
  for (const TermUse& use : p.terms) check_added_term(use);
  for (const std::string& name : p.terms_left_out) builtin_terms().find(name);
  p.frontier_planner = frontier_planner_options_for(robot, p);
  const std::vector<std::string> wrong =
      faults(p.task, p.frontier_planner.traversability.zones.get(),
             p.frontier_planner.traversability.hard_radius);
  if (!wrong.empty()) throw std::invalid_argument("planner: task." + wrong.front());
  if (const std::string misfit = planner_misfit(robot, p, p.map_resolution); !misfit.empty()) {
    throw std::invalid_argument(misfit);
  }
  p.behaviour.turn_away_time = M_PI / robot.model->max_yaw_rate();
  return p;
}

std::shared_ptr<const Solver> required(std::shared_ptr<const Solver> solver) {
  if (!solver) throw std::invalid_argument("planner: no solver; expected one");
  return solver;
}

/// Whether most of the ground cells under the body's disc are unknown to the map.
bool stands_on_unknown(const GroundMap& ground, const Eigen::Vector2d& p, double radius) {
  const GridFrame& frame = ground.frame();
  const auto reach = static_cast<int>(std::ceil(radius / frame.resolution));
  const Cell at = frame.cell(p.x(), p.y());
  int unknown = 0, cells = 0;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      if (std::hypot(i, j) * frame.resolution > radius) continue;
      ++cells;
      if (!ground.explored({at.i + i, at.j + j})) ++unknown;
    }
  }
  return 2 * unknown > cells;
}

/// Turns on the spot, or a stop.
bool drives_nowhere(const Plan& plan) {
  return std::all_of(plan.commands.begin(), plan.commands.end(),
                     [](const Twist& c) { return c.linear.norm() < 1e-3; });
}

/// Adds to why it does not drive.
void tell_unknown_place(const Belief& belief, const PlannerParameters& parameters, Plan& plan) {
  if (parameters.unknown != UnknownPolicy::kFree && drives_nowhere(plan) &&
      stands_on_unknown(*belief.ground, belief.pose.position.head<2>(),
                        parameters.frontier_planner.traversability.hard_radius)) {
    plan.why +=
        " The map knows nothing of where the robot stands, and what is unknown is not entered: "
        "enter the robot's place and the ring that its sensor does not see as free.";
  }
}

/// The body where nothing is, for its discs or spheres: to find them takes milliseconds, of a hull
/// of many corners a quarter of a second, which no step with a deadline has.
std::shared_ptr<const BodyClearance> body_alone(const RobotDescription& robot) {
  const VerticalExtent heights = vertical_extent(robot.shape);
  const double size = 1.0 + circumscribed_radius(robot.shape) +
                      std::max(std::abs(heights.z_min), std::abs(heights.z_max));
  const GridFrame frame{size, 0, 0, 1, 1};
  ClearanceField::Options options;
  options.reach = options.cutoff = size;
  options.vertical = robot.model->pose_layout().pz >= 0;
  options.slice = robot.slice();
  return std::make_shared<const BodyClearance>(
      std::make_shared<const ClearanceField>(Eigen::Vector3d::Zero(), VoxelGrid(frame, 0.0, size),
                                             GroundMap(frame), options),
      robot.shape);
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
  if (belief.pose.position.cwiseAbs().maxCoeff() >= kFarthest) return "the pose is out of range";
  if (!is_finite(belief.twist)) return "the velocity is not finite";
  if (belief.command && !is_finite(*belief.command)) return "the command in force is not finite";
  if (!std::isfinite(belief.stamp)) return "the stamp is not finite";
  const double voxels = belief.voxels->resolution(), ground = belief.ground->frame().resolution;
  if (voxels != ground) {
    return formatted("the voxels are of %.4g m and the ground map of %.4g m; expected the same",
                     voxels, ground);
  }
  return "";
}

/// How much older than the belief the newest whole result is [s].
template <typename T>
double age(const Belief& belief, const Resumed<T>& work) {
  return std::max(0.0, belief.stamp - work.stamp());
}

/// Adds what is old for want of time. prepared: how old the belief is that was prepared from [s].
void tell_age(double prepared, Plan& plan) {
  std::string old;
  const auto tell_one = [&](const char* what, double age) {
    old += formatted("%s%s of %.1f s ago", old.empty() ? "" : ", ", what, age);
  };
  if (plan.age.global_plan > prepared) {
    tell_one(plan.goal ? "the path" : "the target", plan.age.global_plan);
  }
  if (plan.age.landmarks > prepared) tell_one("the landmarks", plan.age.landmarks);
  if (plan.age.clearance > 0.0) tell_one("the distances to obstacles", plan.age.clearance);
  if (!old.empty()) plan.why += " There was no time for newer ones than " + old + '.';
}

/// What the robot did since frontiers were last looked at, over several steps.
FrontierActivity over_both(const FrontierActivity& before, FrontierActivity now) {
  now.pursued = now.pursued && before.pursued;
  now.got_lost = now.got_lost || before.got_lost;
  if (!now.blocked) now.blocked = before.blocked;
  return now;
}

std::vector<Candidate> candidates_of(const std::vector<Seed>& seeds) {
  std::vector<Candidate> candidates;
  for (const Seed& seed : seeds) {
    Candidate c{seed.name, seed.z, 0.0, 0.0};
    c.stops = seed.stops;
    c.rank = candidates.size();
    candidates.push_back(std::move(c));
  }
  return candidates;
}

/// What a part of a step may take [s]: as much as any of the last ones did. It decides nothing but
/// how the time before a deadline is shared out.
class Reserve {
 public:
  explicit Reserve(double first = 0.0) { last_.fill(first); }
  void add(double seconds) {
    if (!begun_) last_.fill(seconds);
    begun_ = true;
    last_[next_] = seconds;
    next_ = (next_ + 1) % last_.size();
  }
  double value() const { return *std::max_element(last_.begin(), last_.end()); }

 private:
  std::array<double, 16> last_{};
  std::size_t next_ = 0;
  bool begun_ = false;
};

/// The share of making and scoring its seeds that no step should be without: eight of them.
double share_of_first_seeds(int scored) {
  constexpr int kFew = 8;
  return std::min(1.0, double{kFew} / std::max(1, scored));
}

/// The time of a step and how it is shared out: what grows with the map is continued in the next
/// step when its share is over, what does not comes after it.
class StepTime {
 public:
  using Clock = Resumable::Clock;
  /// seconds: the deadline, 0: none. after: what the part that does not grow takes [s].
  StepTime(double seconds, double after) : seconds_(seconds), after_(after) {}

  /// When landmarks must be done, or are continued later. Without an earlier whole result nothing
  /// comes after it.
  Clock::time_point landmarks(bool has_earlier) const {
    return at(has_earlier ? std::max(0.1, 0.5 * left()) : kAlone);
  }
  /// The same of frontiers and the path.
  Clock::time_point global_plan(bool has_earlier) const {
    return at(has_earlier ? std::max(0.2, left()) : kAlone);
  }
  /// The same of the way back, from now on.
  Clock::time_point retreat() const { return from_now(std::max(kLeast, 0.1 * seconds_)); }
  /// The same of distances to obstacles, from now on.
  Clock::time_point clearance(bool has_earlier) const {
    return std::max(at(has_earlier ? 0.3 : kAlone),
                    from_now(std::max(kLeast, kClearance * seconds_)));
  }
  /// What of the time that they took [s] is theirs in each step.
  double of_clearance(double took) const { return std::min(took, kClearance * seconds_); }
  /// When no more lines of sight are taken over from the step before, from now on.
  Clock::time_point sights() const { return from_now(0.1 * seconds_); }
  /// Makes seeds until half the time is over that `stop` leaves for making and scoring them.
  StopCondition seeds(const StopCondition& stop) const {
    if (!(seconds_ > 0.0)) return {};
    const double half = 0.5 * std::max(0.0, stop.left());
    return StopCondition(
        [stop, half] { return stop.left() < half ? StopRequest::kDeadline : StopRequest::kNone; });
  }
  /// Whether there is time for what comes after them, or as much as there will be.
  bool suffices() const { return !(seconds_ > 0.0) || Clock::now() <= at(std::max(0.3, left())); }

 private:
  static constexpr double kAlone = 0.9;
  static constexpr double kClearance = 0.2;
  static constexpr double kLeast = 5e-4;  // [s]: so that each step gets on
  double left() const { return 0.95 - after_ / seconds_; }
  Clock::time_point at(double share) const {
    if (!(seconds_ > 0.0)) return Clock::time_point::max();
    return begun_ + duration(std::max(kLeast, share * seconds_));
  }
  Clock::time_point from_now(double seconds) const {
    return seconds_ > 0.0 ? Clock::now() + duration(seconds) : Clock::time_point::max();
  }
  static Clock::duration duration(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  Clock::time_point begun_ = Clock::now();
  double seconds_, after_;
};

/// What plan() makes aside, and Planner::Impl takes over once all of it is there.
struct StepInTheMaking {
  CachedEvaluators evaluators{};
  std::shared_ptr<const GlobalPlan> global_plan{};
  std::shared_ptr<ProblemSpecification> specification{};
  std::size_t num_mapped = 0;    // of the specification's landmarks
  Eigen::VectorXd visibility{};  // now, of all its landmarks
  std::shared_ptr<const Problem> problem{};
  std::vector<Seed> seeds{};  // of the problem, best first

  PlanningStep made() && {
    PlanningStep step{
        std::move(global_plan), specification, std::move(problem), std::move(seeds), {}};
    for (std::size_t i = 0; i < num_mapped; ++i) {
      step.landmarks.push_back(
          {specification->landmarks[i], visibility[static_cast<Eigen::Index>(i)]});
    }
    return step;
  }
};

/// Lowers the weight of the features, in the problem and in the costs of its scored seeds, to where
/// going on is better than waiting (feature_weight.h).
void bound_features(StepInTheMaking& making, std::vector<Candidate>& candidates) {
  const double most = making.specification->weights.visible_features;
  const double weight = feature_weight(candidates, most);
  if (weight >= most) return;
  making.specification->weights.visible_features = weight;
  making.problem = assemble_problem(*making.specification, making.evaluators);
  for (Candidate& c : candidates) c.cost -= (most - weight) * c.features;
  std::stable_sort(candidates.begin(), candidates.end());
}

}  // namespace

struct Planner::Impl {
  RobotDescription robot;
  PlannerParameters parameters;
  std::shared_ptr<const Solver> solver;
  // What was told is in the map's frame in `parameters`, and in the certifier; in W here and in
  // parameters.frontier_planner.
  std::shared_ptr<const ZoneMap> zones;  // null: none
  Task task;
  std::optional<Polygon> told_area;  // parameters.frontier_planner.area, in the map's frame
  std::shared_ptr<const MapFrame> map_frame{};  // of the newest belief
  bool told_moved = false;                      // which the global planner does not know yet
  std::vector<std::shared_ptr<const PlaceMoves>> moved_places{};  // likewise
  std::string corrected{};                                        // what no plan has told yet
  PlanCertifier certifier;
  GlobalPlanner global_planner;
  WorkerThreads workers;
  PolishOptions polish_options;
  double judged_resolution = parameters.map_resolution;  // [m]; 0: none yet
  std::string misfit{};                                  // of it

  std::shared_ptr<const BodyClearance> body = body_alone(robot);

  // From one step to the next.
  CachedEvaluators evaluators;  // of the last step that was made
  TaskClock clock;
  StepMonitors monitors;
  SurfaceDrift drift;
  Behaviour behaviour;
  SafetyLevel safety_level = SafetyLevel::kNormal;
  Eigen::MatrixXd last_inputs;         // nu x N of the last plan
  double last_stamp = 0.0;             // [s]
  std::optional<Plan> last_certified;  // its motion alone: what a stop follows
  Reserve reserve;                     // of the certificate, where there is a deadline
  // Of distances to obstacles, views, the first seeds and the certificate.
  Reserve problem_reserve{0.5 * parameters.deadline};
  StopCondition cancelled;  // of each step
  FrontierActivity activity;
  bool attended = true;            // frontiers have been looked at with it
  std::string refused;             // newest Plan::refused
  bool prepared = false;           // the whole map of the next step is made
  std::optional<double> prepares;  // stamp of the belief of prepare() since the last step
  bool of_frontiers = false;       // what map_work has begun last
  bool change_told = true;         // a step has told what changed in the newest whole map

  // Of the last step: whole, or nothing.
  std::shared_ptr<const PlanningStep> step = std::make_shared<const PlanningStep>();

  Impl(RobotDescription r, PlannerParameters p, std::shared_ptr<const Solver> s)
      : robot(std::move(r)),
        parameters(completed(robot, std::move(p))),
        solver(required(std::move(s))),
        zones(parameters.frontier_planner.traversability.zones),
        task(parameters.task),
        told_area(parameters.task.area),
        certifier(robot, parameters, zones),
        global_planner(robot, parameters),
        workers(parameters.threads),
        polish_options{parameters.polished, parameters.polish_evaluations,
                       parameters.solver_options, shares_threads(*solver)} {}

  void prepare(const Belief& given);
  /// Takes over where W lies in the map's frame (correction.h).
  void follow(const Belief& belief);
  /// Moves what was told to where it lies in W.
  void move_told();
  bool go_on(double seconds);
  Plan plan(const Belief& given, const StopCondition& stop);
  /// step_landmarks(), as of this belief or, where there is no time, an earlier one; null: nor is
  /// there such.
  std::shared_ptr<const StepLandmarks> landmarks(const Belief& belief, StepTime::Clock::time_point);
  /// GlobalPlanner::update(), likewise; whether it is as of this belief.
  bool update_whole_map(const Belief& belief, std::shared_ptr<const StepLandmarks> landmarks,
                        StepTime::Clock::time_point until);
  /// go_on(), works on map_work. What that throws leaves nothing half learned.
  bool go_on_with_whole_map(const std::function<bool()>& go_on);
  /// The mode whose policy this step follows; task, mode and safety level of the plan. None: there
  /// is no whole map yet.
  std::optional<ModeKind> update_mode(const Belief& belief,
                                      const std::shared_ptr<const StepLandmarks>& landmarks,
                                      const StepTime& time, Plan& plan, StepInTheMaking& making);
  /// Of the whole map's, what is to be known now.
  void take_whole_map(const Belief& belief, bool fresh, Facts& facts, Plan& plan,
                      StepInTheMaking& making);
  void specify(const Belief& belief, ModeKind mode, const StepLandmarks& landmarks,
               const StepTime& time, StepInTheMaking& making);
  /// RetreatTrail::cost_to_go(), as of this step or an earlier one; null: there is none.
  std::shared_ptr<const CostToGo> way_back(const Belief& belief, const StepTime& time);
  /// update_clearance(), as of this step or an earlier one; false: there is none yet.
  bool take_clearance(const Belief& belief, const StepTime& time, StepInTheMaking& making);
  /// Seeds of the problem, best first; without the added terms that fail at one.
  std::vector<Candidate> scored_seeds(const Belief& belief, ModePolicy::Seeds wanted,
                                      const StepTime& time, const StopCondition& stop,
                                      StepInTheMaking& making, std::vector<FailedTerm>& failed);
  SeedContext seed_context(const Belief& belief, const StepInTheMaking& making) const;
  void remember(const Plan& plan, StepInTheMaking&& making);
  /// planner_misfit() with maps of that resolution [m].
  const std::string& misfit_with(double resolution);
  Plan brake(const Belief& belief, PlanFault fault, const std::string& why) const;
  void brake_instead(const Belief& belief, Plan& plan) const;

  CandidateEvaluation evaluation(const StepInTheMaking& making) {
    return {*making.problem, making.evaluators.visible_features.get(), parameters.threads, workers};
  }
  void use_zones(const Zones& given);
  void use_task(const Task& given);

  // What takes the longer the more is known of the world. Last: it is unwound before what it
  // works on.
  Resumed<std::shared_ptr<const StepLandmarks>> landmark_work;
  Resumed<WholeMap> map_work;
  Resumed<ClearanceEvaluators> clearance_work;
  Resumed<std::shared_ptr<const CostToGo>> retreat_work;
};

void Planner::Impl::prepare(const Belief& given) {
  prepared = false;
  prepares.reset();
  if (parameters.task.kind != TaskKind::kExplore || !unusable(given).empty()) return;
  follow(given);
  const StepTime time(parameters.deadline, 0.0);
  const std::shared_ptr<const StepLandmarks> seen =
      landmarks(given, time.landmarks(landmark_work.newest().has_value()));
  if (!seen) return;
  prepares = given.stamp;
  prepared = update_whole_map(given, seen, time.global_plan(true));
}

bool Planner::Impl::go_on(double seconds) {
  if (std::isnan(seconds)) seconds = 0.0;
  const StepTime::Clock::time_point until =
      StepTime::Clock::now() + std::chrono::duration_cast<StepTime::Clock::duration>(
                                   std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)));
  landmark_work.go_on(until);
  clearance_work.go_on(until);
  retreat_work.go_on(until);
  if (map_work.busy()) {
    const bool made = go_on_with_whole_map([&] { return map_work.go_on(until); });
    prepared = made && prepares && map_work.stamp() == *prepares;
  }
  return landmark_work.busy() || clearance_work.busy() || retreat_work.busy() || map_work.busy();
}

std::shared_ptr<const StepLandmarks> Planner::Impl::landmarks(const Belief& belief,
                                                              StepTime::Clock::time_point until) {
  landmark_work.update(
      belief.stamp,
      [this, belief](const PausePoint& pause) {
        return std::make_shared<const StepLandmarks>(
            step_landmarks(robot, parameters, belief, pause));
      },
      until);
  return landmark_work.newest().value_or(nullptr);
}

bool Planner::Impl::update_whole_map(const Belief& given, std::shared_ptr<const StepLandmarks> seen,
                                     StepTime::Clock::time_point until) {
  Belief belief = given;
  belief.landmarks = seen->usable;
  const auto make = [this, belief, told = task, seen = std::move(seen), did = activity,
                     stamp = given.stamp - clock.away()](const PausePoint& pause) {
    attended = true;
    of_frontiers = parameters.task.kind == TaskKind::kExplore;
    for (const auto& moves : std::exchange(moved_places, {})) global_planner.follow(*moves);
    if (std::exchange(told_moved, false)) {
      global_planner.follow(parameters.frontier_planner, told);
    }
    WholeMap whole = global_planner.update(
        belief, parameters, stamp, did, seen->texture ? &*seen->texture : nullptr, workers, pause);
    change_told = false;
    return whole;
  };
  return go_on_with_whole_map([&] { return map_work.update(given.stamp, make, until); });
}

bool Planner::Impl::go_on_with_whole_map(const std::function<bool()>& go_on) {
  try {
    return go_on();
  } catch (...) {
    map_work.give_up();
    global_planner.restart(parameters.frontier_planner);
    throw;
  }
}

Plan Planner::Impl::plan(const Belief& given, const StopCondition& asked) {
  Stopwatch total, watch;
  const StopCondition outer = asked || cancelled;
  // Of all of the step; its polishing leaves time for what comes after it.
  const StopCondition late =
      parameters.deadline > 0.0 ? deadline(parameters.deadline) : StopCondition();
  const StepTime time(parameters.deadline, problem_reserve.value());
  const StopCondition stop = parameters.deadline > 0.0
                                 ? (deadline(parameters.deadline - reserve.value()) || outer)
                                 : outer;
  step = std::make_shared<const PlanningStep>();
  if (const std::string why = unusable(given); !why.empty()) {
    return brake(given, PlanFault::kBelief, "planning is impossible: " + why);
  }
  if (const std::string& why = misfit_with(given.voxels->resolution()); !why.empty()) {
    return brake(given, PlanFault::kMisfit, "planning is impossible: " + why);
  }
  follow(given);
  const std::optional<double> prepared_from = std::exchange(prepares, std::nullopt);
  // Of a step that fails, what is only kept to save time is forgotten, too.
  StepInTheMaking making{.evaluators = std::move(evaluators)};
  Plan plan;
  plan.stamp = given.stamp;
  plan.solver = solver->name();

  // Belief.
  Belief belief = given;
  const std::shared_ptr<const StepLandmarks> seen =
      landmarks(belief, time.landmarks(landmark_work.newest().has_value()));
  drift.update(belief, robot);
  const auto unfinished = [&](const char* what) {
    return brake(given, PlanFault::kUnfinished,
                 std::string(what) + " of the first map take longer than the deadline of a step");
  };
  if (!seen) return unfinished("the landmarks");
  belief.landmarks = seen->usable;
  plan.age.landmarks = age(given, landmark_work);
  plan.landmarks_dropped = seen->dropped;
  plan.landmark_fault = seen->fault;

  // Mode.
  const std::optional<ModeKind> mode_now = update_mode(belief, seen, time, plan, making);
  if (!mode_now) return unfinished("the frontiers");
  const ModeKind mode = *mode_now;
  plan.times.frontier_planner = watch.lap();

  // Problem.
  ProcessorStopwatch work;  // of this thread: what the rest takes where nothing else keeps it busy
  specify(belief, mode, *seen, time, making);
  ProblemSpecification& specification = *making.specification;
  plan.times.views = watch.lap();
  if (!take_clearance(belief, time, making)) return unfinished("the distances to obstacles");
  plan.age.clearance = age(given, clearance_work);
  plan.times.clearance = watch.lap();
  update_views(specification, making.evaluators, time.sights());
  making.visibility = making.evaluators.prediction->probabilities(belief.pose);
  plan.times.views += watch.lap();
  const double views_took = work.lap();
  std::vector<FailedTerm> failed = make_added_terms(specification, making.evaluators);
  making.problem = assemble_problem(specification, making.evaluators);

  // Seeds.
  const ModePolicy::Seeds wanted = policy(mode).seeds;
  std::vector<Candidate> candidates = scored_seeds(belief, wanted, time, stop, making, failed);
  if (mode == ModeKind::kExplore && belief.localization != Localization::kLost) {
    bound_features(making, candidates);
  }
  for (const Candidate& c : candidates) making.seeds.push_back({c.name, c.z, c.stops});
  plan.features_weight = specification.weights.visible_features;
  plan.seeds_scored = static_cast<int>(candidates.size());
  plan.counters.cost_evaluations = plan.seeds_scored;
  plan.times.seeds = watch.lap();
  const double seeds_took = work.lap();

  // Solve.
  if (wanted == ModePolicy::Seeds::kAll) {
    const PolishOutcome outcome =
        polish(candidates, *solver, polish_options, evaluation(making), stop);
    plan.counters.cost_evaluations += outcome.counters.cost_evaluations;
    plan.counters.gradient_evaluations = outcome.counters.gradient_evaluations;
    plan.counters.iterations = outcome.counters.iterations;
    plan.stop = outcome.stop;
    plan.detail = outcome.error;
  } else {
    // They are what the optimisation did not find: the first certified one is taken.
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
  }
  plan.times.polish = watch.lap();
  work.lap();

  // Certificate.
  const int committed =
      std::min(parameters.N,
               std::max(1, static_cast<int>(std::lround(parameters.committed / parameters.dt))));
  if (!choose_certified(candidates,
                        {belief, *making.problem, certifier, safety_level, drift,
                         *making.evaluators.visible_features, committed, late},
                        plan)) {
    brake_instead(belief, plan);
  }
  tell_unknown_place(belief, parameters, plan);
  tell_age(prepared_from ? std::max(0.0, given.stamp - *prepared_from) : 0.0, plan);
  tell(failed, plan);
  if (outer() == StopRequest::kCancelled) {
    plan.stop = StopReason::kCancelled;
  } else if (plan.stop == StopReason::kCancelled) {
    plan.stop = StopReason::kNumericalTrouble;  // a solver ended that nobody had cancelled
  }
  plan.times.certify = watch.lap();
  const double certificate_took = work.lap();
  reserve.add(1e-3 * certificate_took);
  problem_reserve.add(time.of_clearance(1e-3 * plan.times.clearance) +
                      1e-3 * (views_took + share_of_first_seeds(plan.seeds_scored) * seeds_took +
                              certificate_took));

  remember(plan, std::move(making));
  plan.times.total = total.lap();
  return plan;
}

std::optional<ModeKind> Planner::Impl::update_mode(const Belief& belief,
                                                   const std::shared_ptr<const StepLandmarks>& seen,
                                                   const StepTime& time, Plan& plan,
                                                   StepInTheMaking& making) {
  const TaskKind task = parameters.task.kind;
  clock.update(belief.stamp, task);
  Facts facts = monitors.update(belief, task, clock, parameters.features.N_min);
  // What comes before the frontiers in the table tells whether it pursues its target.
  const ModeKind before_frontiers = decide(behaviour, facts, parameters.behaviour).mode.kind;
  const bool pursues = policy(before_frontiers).pursues;
  facts.stuck = monitors.update_stuck(belief, pursues);
  facts.refused = refused;
  const FrontierActivity now{.observed = belief.localization != Localization::kLost,
                             .pursued = pursues,
                             .got_lost = monitors.got_lost(),
                             .blocked = monitors.blocked()};
  activity = attended ? now : over_both(activity, now);
  attended = false;
  bool fresh = std::exchange(prepared, false);
  if (!fresh) {
    const bool has_earlier = map_work.newest().has_value();
    fresh = update_whole_map(belief, seen, time.global_plan(has_earlier));
    if (!map_work.newest() || (!has_earlier && !time.suffices())) return std::nullopt;
  }
  take_whole_map(belief, fresh, facts, plan, making);
  behaviour = decide(behaviour, facts, parameters.behaviour);
  safety_level = safety_level_for(facts, parameters.lost_margin > 0.0);
  plan.task = task;
  plan.goal = global_planner.goal();
  plan.mode = behaviour.mode;
  plan.safety_level = safety_level;
  plan.why = describe(behaviour.mode, facts) + std::exchange(corrected, {});
  plan.has_active_frontier = making.global_plan->target.has_value();
  if (facts.goal && facts.goal->reached) plan.heading_missed = facts.goal->heading_missed;
  if (behaviour.mode.kind != ModeKind::kDone) return behaviour.mode.kind;
  // A robot that is done has no target any more, but a retreat or a turn goes on.
  return task == TaskKind::kExplore ? before_frontiers : ModeKind::kHold;
}

void Planner::Impl::take_whole_map(const Belief& belief, bool fresh, Facts& facts, Plan& plan,
                                   StepInTheMaking& making) {
  const WholeMap& whole = *map_work.newest();
  making.global_plan = whole.global_plan;
  facts.frontiers = whole.frontiers;
  facts.goal = whole.goal;
  plan.age.global_plan = age(belief, map_work);
  if (std::exchange(change_told, true) && facts.frontiers)
    facts.frontiers->changed = TargetChange::kNone;
  // The arrival is judged where the robot is.
  if (!fresh && facts.goal) {
    judge_arrival(*global_planner.goal(), belief.pose, facts.goal->heading_missed.has_value(),
                  *facts.goal);
  }
}

std::shared_ptr<const CostToGo> Planner::Impl::way_back(const Belief& belief,
                                                        const StepTime& time) {
  if (map_work.busy()) {  // it works on what is passable
    retreat_work.go_on(time.retreat());
  } else {
    const Eigen::Vector2d here = belief.pose.position.head<2>();
    retreat_work.update(
        belief.stamp,
        [trail = monitors.trail(), here, v_max = robot.model->max_speed(),
         factors = RetreatTrail::factors_around(here, global_planner.traversability())](
            const PausePoint& pause) {
          return trail.cost_to_go(factors, here, v_max, RetreatTrail::kAway, pause);
        },
        time.retreat());
  }
  return retreat_work.newest().value_or(nullptr);
}

void Planner::Impl::specify(const Belief& belief, ModeKind mode, const StepLandmarks& seen,
                            const StepTime& time, StepInTheMaking& making) {
  const bool retreats = policy(mode).cost_to_go == ModePolicy::CostToGo::kRetreat;
  if (!retreats) retreat_work.forget();
  const std::shared_ptr<const CostToGo> retreat = retreats ? way_back(belief, time) : nullptr;
  StepSpecification made =
      specify_problem({robot, parameters, belief, *making.global_plan, global_planner.frontiers(),
                       zones, mode, retreat, safety_level, drift, seen});
  making.specification = std::make_shared<ProblemSpecification>(std::move(made.problem));
  making.num_mapped = made.num_mapped;
}

bool Planner::Impl::take_clearance(const Belief& belief, const StepTime& time,
                                   StepInTheMaking& making) {
  ClearanceEvaluators& now = making.evaluators;
  const bool has_earlier = clearance_work.newest().has_value();
  if (has_earlier && now.occupied == nullptr) now = *clearance_work.newest();
  if (now.body == nullptr) now.body = body;
  clearance_work.update(
      belief.stamp,
      [specification = making.specification, before = now](const PausePoint& pause) {
        ClearanceEvaluators made = before;
        update_clearance(*specification, made, pause);
        return made;
      },
      time.clearance(has_earlier));
  if (!clearance_work.newest() || (!has_earlier && !time.suffices())) return false;
  now = *clearance_work.newest();
  return true;
}

std::vector<Candidate> Planner::Impl::scored_seeds(const Belief& belief, ModePolicy::Seeds wanted,
                                                   const StepTime& time, const StopCondition& stop,
                                                   StepInTheMaking& making,
                                                   std::vector<FailedTerm>& failed) {
  SeedContext context = seed_context(belief, making);
  context.stop = time.seeds(stop);
  const std::vector<Seed> made = make_seeds(*making.problem, std::move(context), wanted,
                                            kTurnsWithin * parameters.task.goal.position_tolerance);
  if (const std::vector<FailedTerm> more =
          try_added_terms(*making.specification, making.evaluators, made);
      !more.empty()) {
    failed.insert(failed.end(), more.begin(), more.end());
    making.problem = assemble_problem(*making.specification, making.evaluators);
  }
  return evaluate(candidates_of(made), Evaluate::kScore, evaluation(making), stop);
}

SeedContext Planner::Impl::seed_context(const Belief& belief, const StepInTheMaking& making) const {
  SeedContext context;
  context.cost_to_go = making.global_plan->cost_to_go.get();
  context.target = making.global_plan->target;
  context.clearance = making.evaluators.occupied.get();
  if (parameters.unknown == UnknownPolicy::kBraking) {
    context.known = making.evaluators.known_body.get();
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
  return context;
}

void Planner::Impl::remember(const Plan& plan, StepInTheMaking&& making) {
  if (!plan.refused.empty()) refused = plan.refused;
  evaluators = std::move(making.evaluators);
  step = std::make_shared<const PlanningStep>(std::move(making).made());
  last_stamp = plan.stamp;
  if (plan.certified) {
    last_certified.emplace();
    last_certified->stamp = plan.stamp;
    last_certified->dt = plan.dt;
    last_certified->committed = plan.committed;
    last_certified->certified = true;
    last_certified->states = {plan.states.front()};
    last_certified->commands = plan.commands;
    last_certified->tail = plan.tail;
    last_certified->ramp_from = plan.ramp_from;
  }
  last_inputs.resize(robot.model->nu(), static_cast<Eigen::Index>(plan.inputs.size()));
  for (std::size_t k = 0; k < plan.inputs.size(); ++k) {
    last_inputs.col(static_cast<Eigen::Index>(k)) = plan.inputs[k];
  }
}

const std::string& Planner::Impl::misfit_with(double resolution) {
  if (resolution != judged_resolution) {
    misfit = planner_misfit(robot, parameters, resolution);
    judged_resolution = resolution;
  }
  return misfit;
}

Plan Planner::Impl::brake(const Belief& belief, PlanFault fault, const std::string& why) const {
  Plan plan = stopping_plan(belief, *robot.model, parameters.dt,
                            {parameters.task.kind, behaviour.mode, safety_level,
                             last_certified ? &*last_certified : nullptr, &certifier.guard()},
                            why);
  plan.fault = fault;
  return plan;
}

void Planner::Impl::brake_instead(const Belief& belief, Plan& plan) const {
  const std::string why = "no candidate could be certified: " + plan.certificate;
  const Plan halt = brake(belief, PlanFault::kNone, why);
  plan.kind = halt.kind;
  plan.dt = halt.dt;
  plan.states = halt.states;
  plan.inputs = halt.inputs;
  plan.commands = halt.commands;
  plan.tail = halt.tail;
  plan.ramp_from = halt.ramp_from;
  plan.committed = halt.committed;
  plan.certified = halt.certified;
  plan.detail = why;
  plan.why += " It brakes: " + why + '.';
}

void Planner::Impl::follow(const Belief& belief) {
  const std::shared_ptr<const MapFrame> before = std::exchange(map_frame, belief.map_frame);
  if (map_frame == before) return;
  const MapFrame none;
  const MapFrame& now = map_frame ? *map_frame : none;
  const MapFrame& then = before ? *before : none;
  if (now.taken > then.taken && now.newest) {
    const int more = now.taken - then.taken - 1;
    corrected += more > 0 ? formatted(" %d corrections, then: ", more) : " Correction: ";
    corrected += to_text(*now.newest) + '.';
  }
  if (now.refused + now.cannot_follow > then.refused + then.cannot_follow) {
    corrected += " Note: " + now.refusal + '.';
  }
  for (const MovedPlaces& moved : now.moved_places) {
    if (moved.taken <= then.taken) continue;
    drift.follow(*moved.how);
    monitors.follow(*moved.how);
    moved_places.push_back(moved.how);
    prepared = false;
  }
  if (now.origin.position == then.origin.position && now.origin.yaw == then.origin.yaw) return;
  move_told();
  if (zones == nullptr && !told_area && task.kind != TaskKind::kGoTo) return;
  told_moved = true;
  prepared = false;
  const std::vector<std::string> wrong =
      faults(task, zones.get(), parameters.frontier_planner.traversability.hard_radius);
  if (!wrong.empty()) corrected += " Since then the " + wrong.front() + '.';
}

void Planner::Impl::move_told() {
  const Pose T_WM = map_frame ? map_frame->map_in_W() : Pose();
  task = moved(parameters.task, T_WM);
  zones = zone_map_of(moved(parameters.zones, T_WM));
  FrontierPlannerOptions& options = parameters.frontier_planner;
  options.traversability.zones = zones;
  options.area.reset();
  if (told_area) options.area = moved(*told_area, T_WM);
}

void Planner::Impl::use_zones(const Zones& given) {
  parameters.zones = given;
  certifier.set_zones(zone_map_of(given));
  move_told();
  prepared = false;
  map_work.give_up();
  clearance_work.give_up();
  global_planner.restart(parameters.frontier_planner);
}

void Planner::Impl::use_task(const Task& given) {
  const bool other_area = given.kind == TaskKind::kExplore && given.area != told_area;
  // What was learned of frontiers is kept: what is under way of them is done first.
  if (map_work.busy() && of_frontiers && !other_area) {
    map_work.forget();
  } else {
    map_work.give_up();
  }
  parameters.task = given;
  if (other_area) told_area = given.area;
  move_told();
  prepared = false;
  clock.restart();
  global_planner.restart_task(task);
  if (!other_area) return;
  global_planner.restart(parameters.frontier_planner);
}

Planner::Planner(RobotDescription robot, PlannerParameters parameters,
                 std::shared_ptr<const Solver> solver)
    : impl_(std::make_unique<Impl>(std::move(robot), std::move(parameters), std::move(solver))) {}
Planner::~Planner() = default;

void Planner::prepare(const Belief& belief) {
  try {
    impl_->prepare(belief);
  } catch (...) {
    // plan() meets the same and tells it.
    impl_->prepared = false;
  }
}

bool Planner::go_on(double seconds) {
  try {
    return impl_->go_on(seconds);
  } catch (...) {
    return false;  // plan() begins it anew, and tells what is wrong
  }
}

Plan Planner::plan(const Belief& belief, const StopCondition& stop) {
  try {
    return impl_->plan(belief, stop);
  } catch (const std::exception& e) {
    return impl_->brake(belief, PlanFault::kError, std::string("planning failed: ") + e.what());
  } catch (...) {
    return impl_->brake(belief, PlanFault::kError, "planning failed");
  }
}

std::string Planner::set_task(const Task& task) {
  const Planner::Impl& s = *impl_;
  const Task in_W = moved(task, s.map_frame ? s.map_frame->map_in_W() : Pose());
  const std::vector<std::string> wrong =
      faults(in_W, s.zones.get(), s.parameters.frontier_planner.traversability.hard_radius);
  if (!wrong.empty()) return wrong.front();
  impl_->use_task(task);
  return "";
}
void Planner::set_cancelled(std::function<bool()> cancelled) {
  impl_->cancelled = cancelled_by(std::move(cancelled));
}
const Task& Planner::task() const { return impl_->parameters.task; }
std::string Planner::set_zones(const Zones& zones) {
  const std::vector<std::string> wrong = faults(zones);
  if (!wrong.empty()) return wrong.front();
  impl_->use_zones(zones);
  return "";
}
std::shared_ptr<const PlanningStep> Planner::step() const { return impl_->step; }
std::optional<ReturnPath> Planner::return_path(const Belief& belief) const {
  if (!unusable(belief).empty()) return std::nullopt;
  try {
    return impl_->global_planner.return_path(belief, *impl_->robot.model);
  } catch (...) {
    return std::nullopt;
  }
}
std::shared_ptr<const GlobalPlan> Planner::global_plan() const { return impl_->step->global_plan; }
std::shared_ptr<const Problem> Planner::problem() const { return impl_->step->problem; }
std::shared_ptr<const ProblemSpecification> Planner::specification() const {
  return impl_->step->specification;
}
const std::vector<Seed>& Planner::seeds() const { return impl_->step->seeds; }
const PlannerParameters& Planner::parameters() const { return impl_->parameters; }
const RobotDescription& Planner::robot() const { return impl_->robot; }
Guard Planner::make_guard(const Guard::Options& options) const {
  return guard_for(impl_->robot, impl_->parameters, options);
}

}  // namespace prospect
