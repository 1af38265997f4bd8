// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/behaviour/behaviour.h"
#include "engine/features/visibility_prediction.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/belief.h"
#include "engine/maps/unknown_policy.h"
#include "engine/planner/planning_step.h"
#include "engine/planner/replanner.h"
#include "engine/planner/seeds.h"
#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "engine/problem/term_registry.h"
#include "engine/safety/guard.h"
#include "engine/safety/plan.h"
#include "engine/task/task.h"
#include "engine/task/zones.h"
#include "engine/terms/problem_specification.h"
#include "engine/terms/visible_features.h"
#include "models/robot_description.h"

namespace prospect {

class Knobs;

/// Everything that can be set about planning. Weights multiply terms that are O(1) at nominal
/// conditions (formulation, section 7), so they carry over between robots and horizons.
struct PlannerParameters {
  int N = 20;        ///< stages
  double dt = 0.25;  ///< [s]
  int M = 10;        ///< knots

  /// Of the built-in costs, as asked for. In a step the mode scales those of visible features and
  /// exploration gain (mode_policy.h), and the first is bounded (feature_weight.h). That of the
  /// features: docs/results/experiments.md.
  ProblemSpecification::Weights weights{.control_effort = 0.02,
                                        .input_rate = 0.03,
                                        .obstacles = 0.5,
                                        .visible_features = 2.0,
                                        .exploration_gain = 1.0,
                                        .cost_to_go = 1.5};
  double w_c = 0.0;            ///< chance penalty on the number of visible features
  double desired_speed = 1.0;  ///< share of the largest speed
  /// Terms that are not built in, and built-in ones that the problem is to lack: set_term.h.
  std::vector<TermUse> terms{};
  std::vector<std::string> terms_left_out{};

  /// Hard clearance [m]. Small, because the lattice understates it by up to half a voxel in gaps,
  /// and a constraint stricter than what the cost-to-go takes for passable leaves the robot in
  /// places from which nothing can be reached. Comfort is d_des's part, certainty the
  /// certificate's.
  double d_safe = 0.01;
  double d_des = 0.25;  ///< clearance beyond which the soft cost vanishes [m]
  UnknownPolicy unknown = UnknownPolicy::kBraking;
  /// Ground whose floor no ray has met is not driven onto (certificate.h).
  UnseenFloor unseen_floor = UnseenFloor::kAssumed;
  double step = 0.05;                ///< [m] HeightSlice::step of the maps that beliefs will bring
  double certificate_margin = 0.02;  ///< by which the certified body is grown [m]
  /// Margin that a guard of these plans must use [m]: smaller, so that what was certified with the
  /// whole margin passes from the slightly different pose at which it is executed.
  double guard_margin() const { return 0.25 * certificate_margin; }
  /// How much farther than that surfaces are kept away that may have drifted since they were last
  /// in view (surface_drift.h), at most [m]; 0: none. The soft cost's clearances grow by the drift
  /// of what is near, too. Not while localization is lost, nor while stuck (safety_level.h).
  double drift_margin = 0.12;
  /// Space that may have drifted by more since it was last in view counts as unknown for the
  /// certificate [m]; 0: none does. Also while localization is lost; not while stuck.
  double drift_limit = 0.12;
  /// The certificate's margin while localization is lost [m], stuck or not; 0: as else.
  double lost_margin = 0.0;

  double committed = 0.5;  ///< [s] of a plan that are certified and executed before the next
  int polished = 2;        ///< seeds handed to the solver
  /// Cost evaluations each; a solver that compares starts gets all seeds and the sum of these.
  int polish_evaluations = 24;
  Options solver_options;  ///< passed to the solver besides
  /// That share the feature visibility map, the score of the seeds and the polishing: a seed each,
  /// or what a solver that compares starts shares if it has the option `threads`. The same bits for
  /// any number. The solver is then called from several threads at once, the stop condition from
  /// one at a time.
  int threads = 1;
  double deadline = 0.0;  ///< wall-clock limit of a step [s]; 0: none, results are reproducible
  /// Side of the voxels of the maps that beliefs will bring [m]: then the constructor says whether
  /// all fits together (planner_fit.h). 0: not known yet; the first step says it.
  double map_resolution = 0.0;

  int max_landmarks = 300;          ///< a quarter of them at most for what has not been seen
  double visibility_lattice = 0.3;  ///< spacing of the occlusion tables [m]
  VisibilityParameters visibility = with_redetected_landmarks();
  VisibleFeaturesParameters features{.criterion = VisibilityCriterion::kInformation};
  /// Count features expected in unknown space (unseen_features.h), of the landmark map's density.
  bool feature_prior = true;
  double feature_attenuation = 0.3;  ///< of rays to features through unknown space [1/m]
  /// Parts of the prediction that can be left out, to study what they are worth. Without occlusion
  /// every feature has a free line of sight to wherever the camera is not deep in a wall (and
  /// feature_attenuation has no effect); without covariance landmarks and motion are exact, and
  /// only the noise of an image point is left. Ways (frontier_planner) are not concerned.
  bool feature_occlusion = true;
  bool feature_covariance = true;
  int max_targets = 200;
  bool target_frontier_only =
      false;  ///< count gain only at the frontier that the frontier planner leads to
  double unknown_attenuation = 0.5;  ///< lambda [1/m] of rays to targets through unknown space

  FrontierPlannerOptions frontier_planner;

  Task task;    ///< what the robot does until Planner::set_task() says otherwise
  Zones zones;  ///< where it may not be, or not fast
  /// What a metre through unknown space counts as on the path to a goal, and back to the start
  /// (along what is known, if that leads there), 1 to 1000.
  double goal_unknown_price = 2.0;
  double return_unknown_price = 20.0;

  BehaviourOptions behaviour;  ///< turn_away_time is half a turn of the robot, whatever is set
};

/// The knobs (models/knobs.h) but for task, zones and solver_options, which are no numbers, for
/// map_resolution, which is the map's, and for those of frontier_planner that describe_end() has.
void describe(Knobs& knobs, PlannerParameters& parameters);

/// One replanning step: Belief in, Plan out.
///
///   belief -> facts -> mode -> problem -> seeds -> batch score -> polish the best few
///          -> exact certificate -> else the stopping tail.
///
/// plan() never throws and always returns an executable plan: its commands are finite, within
/// limits, and certified with the stop that follows, or they are a stop; the plan says why
/// (PlanFault). All
/// state from one step to the next (frontier memory, clearance field, occlusion tables, previous
/// plan) lives here; none of it changes what is safe. Nor does it rest on how a map came about: a
/// belief may bring any map after any other, one projected anew each time (belief_maps()) too.
///
/// Landmarks that cannot be used are left out and counted (Plan::landmarks_dropped). Of a robot
/// whose localization is its own (LocalizationSource::kExternal) none is used or needed: features
/// cost nothing, and few of them are no reason for a retreat.
///
/// What the robot is doing is decided by one table (behaviour/behaviour.h): monitors and maps say
/// what is, the table says the mode, and a policy what that means for weights, seeds and the
/// certificate.
///
/// A belief whose pose error nothing bounds (pose_error.h: lost and far off, or a covariance that
/// is none) is planned on all the same, but nothing counts as where the map has it that is not in
/// view now (surface_drift.h, certificate.h): what can be certified is turning on the spot, driving
/// where the robot looks, or a stop. The guard asks the same.
///
/// Tasks. set_task() between two plans: explore, go to a pose, return to the pose of the first
/// plan, hold. A task that is over is over until another is given: the robot stays where it is.
/// Going on exploring after another task, what was learned of frontiers is kept, and the time in
/// between does not count; with another area than before it begins anew.
///
/// Zones: certificate, and so planner and guard, keep the body out of what is forbidden and the
/// speed within what is allowed; the cost-to-go leads round; the clearance terms count forbidden
/// parts as obstacles; frontiers in them are no targets.
///
/// Corrections (correction.h). Task and zones are in the map's frame; where that lies in W the
/// belief says, and when it moves they move in W, with all else as it was. A plan's `why` tells of
/// each correction, and of a goal that lies where none may be now. Plan::goal is in W.
///
/// Ahead of the step. prepare() looks for the frontiers and the path to them, which takes about
/// half of a step. The plan() after it takes them as they are: they are of prepare()'s belief, and
/// of what the robot was doing at the plan before. The mode, the obstacles, the views, the problem
/// and the certificate are of plan()'s own belief always. The path to a goal is never prepared: the
/// arrival is judged where the robot is. Another task or other zones drop what was prepared.
///
/// Deadline. PlannerParameters::deadline is that of plan(), and of prepare(). What takes the longer
/// the more is known of the world, landmarks, frontiers, the path, and distances to obstacles, is
/// continued in the next step when its share of the time is over (support/resumed.h), and by
/// go_on() before. Until then the last whole result serves: Plan::age says how old it is. Before
/// the first there is none, and the step is a stop (PlanFault::kUnfinished). Lines of sight of the
/// step before are taken over for a tenth of the time; what is not is cast again. Seeds, the
/// shifted previous plan first, are made for half of what is left beside the certificate, and
/// scored two at a time until it is over; then polishing ends; then one candidate is certified.
///
/// Terms from outside (PlannerParameters::terms) are made and tried at each step; one that cannot
/// be made, or evaluated at any seed, is left out of the step, and the plan's `detail` says so.
///
/// Determinism: with deadline = 0, the same sequence of calls and beliefs gives the same bits.
/// Thread-safety: one thread a planner. Source: formulation, sections 4 to 8.
class Planner final : public Replanner {
 public:
  /// Throws std::invalid_argument naming the parameter, its value and what was expected: of the
  /// parameters, of all of the robot, and of how they fit together (planner_misfit()). (What a
  /// solver does not take is in Plan::detail.)
  Planner(RobotDescription robot, PlannerParameters parameters,
          std::shared_ptr<const Solver> solver);
  ~Planner() override;
  Planner(const Planner&) = delete;
  Planner& operator=(const Planner&) = delete;

  void prepare(const Belief& belief) override;
  bool go_on(double seconds) override;
  Plan plan(const Belief& belief) override { return plan(belief, {}); }
  /// The same; polishing also ends when `stop` says so, and by a deadline in it scoring.
  Plan plan(const Belief& belief, const StopCondition& stop);
  /// Asked, as `stop` is, in each plan() from now on; empty: never true. A plan during which one of
  /// them was cancelled has Plan::stop kCancelled, and no other has: nothing can repeat it.
  void set_cancelled(std::function<bool()> cancelled);

  /// "" if the task is taken, else its first fault (task.h).
  std::string set_task(const Task& task) override;
  const Task& task() const;
  /// Other zones from the next plan() on, for the planner; a guard has its own. "" if they are
  /// taken, else their first fault (zones.h). What was learned of frontiers is forgotten.
  std::string set_zones(const Zones& zones);

  std::optional<ReturnPath> return_path(const Belief& belief) const override;

  /// What the last step made besides its plan (planning_step.h). Never null; of nothing before the
  /// first step, and after one that failed or that had a belief that nothing can be planned from.
  std::shared_ptr<const PlanningStep> step() const override;
  /// The entries of step(), which the next plan() replaces.
  std::shared_ptr<const GlobalPlan> global_plan() const override;
  std::shared_ptr<const Problem> problem() const;
  std::shared_ptr<const ProblemSpecification> specification() const;
  const std::vector<Seed>& seeds() const;

  /// guard_for() this robot and these parameters (planner_guard.h).
  Guard make_guard(const Guard::Options& options = {}) const;

  const PlannerParameters& parameters() const;
  const RobotDescription& robot() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
