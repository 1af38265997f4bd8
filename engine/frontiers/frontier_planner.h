// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "engine/behaviour/facts.h"
#include "engine/behaviour/monitors/exhaustion_monitor.h"
#include "engine/behaviour/monitors/progress_monitor.h"
#include "engine/features/feature_visibility_map.h"
#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/cost_to_go_field.h"
#include "engine/frontiers/frontier_order.h"
#include "engine/frontiers/frontier_standing.h"
#include "engine/frontiers/frontier_utility.h"
#include "engine/frontiers/frontiers.h"
#include "engine/frontiers/path_lengths.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/traversability.h"
#include "engine/task/polygon.h"
#include "models/types.h"

namespace prospect {

class Knobs;

/// Chooses among the candidates the one that is led to: an index, -1 for none. current: index of
/// the present target among them, -1 if there is none or it is no candidate any more.
using TargetRule = std::function<int(const std::vector<FrontierCandidate>&, int current)>;

struct FrontierPlannerOptions {
  TraversabilityOptions traversability;
  FrontierOptions frontiers;
  FrontierUtilityOptions utility;
  FrontierOrderOptions order;
  CostToGoOptions cost_to_go;
  std::optional<Polygon> area{};  ///< only frontiers in here are led to; none: all
  ProgressMonitor::Options progress;

  double least_area = 0.1;        ///< [m^2] a frontier that promises less is not gone to
  double least_rate = 0.017;      ///< [m^2/s] nor are those that do for the time that they take
  double observation_time = 2.0;  ///< [s] of an observation, beside the path to it
  double turn_time = 1.0;         ///< [s/rad] of turning: 1 / omega_max
  double observation_length =
      2.0;  ///< [m] of travel that an observation counts as where features are few

  double reconsider = 2.0;     ///< [s] between two questions whether another target is better
  double commitment = 0.25;    ///< share by which another sequence must be better
  double resolved = 0.5;       ///< share of a target's area at whose loss the next one is chosen
  double target_radius = 1.0;  ///< [m] how far a target may move in a step and stay the same
  /// [s] for which a place that could not be passed is impassable, if something else is left.
  double closing_time = 100.0;

  /// Chooses the target instead of best_sequence(), asked as often. Null: best_sequence() does.
  TargetRule rule;
};

/// The knobs of all parts (models/knobs.h), in one group: all but those of describe_end().
/// turn_time and area come from robot and task.
void describe(Knobs& knobs, FrontierPlannerOptions& options);
/// Those that decide when nothing is left that is worth going to.
void describe_end(Knobs& knobs, FrontierPlannerOptions& options);

/// What the robot did since the last update.
struct FrontierActivity {
  bool observed = true;   ///< images extended the map: what was in view was looked at
  bool pursued = true;    ///< it tried to reach the target; false: it had something else to do
  bool got_lost = false;  ///< localization was lost on the path: that visit has failed
  /// Direction in W in which the robot does not get on, though the map says so: a disc there is
  /// impassable for closing_time, or until nothing else is left.
  std::optional<Eigen::Vector2d> blocked{};
};

/// Where the cost-to-go leads the robot.
struct FrontierTarget {
  int frontier = -1;                                    ///< index in GlobalPlan::frontiers
  Eigen::Vector2d viewpoint = Eigen::Vector2d::Zero();  ///< in W [m]
  Eigen::Vector2d looks_at =
      Eigen::Vector2d::Zero();  ///< a frontier cell seen from there, in W [m]
  double yaw = 0.0;             ///< heading there that faces it [rad]
};

/// What one planning step needs to know about the frontiers; immutable.
struct GlobalPlan {
  std::uint64_t map_revision = 0;
  double stamp = 0.0;                          ///< [s]
  std::vector<Frontier> frontiers;             ///< all clusters, active or not
  std::shared_ptr<const CostToGo> cost_to_go;  ///< never null
  std::optional<FrontierTarget> target;        ///< none: nothing is reachable
  FrontierFacts facts;                         ///< what the behaviour is decided by
  /// Of a step that asked which frontier is next: all active ones, first those of the sequence in
  /// its order, then the others by area. Else empty.
  std::vector<FrontierStanding> standings;
  double explored_area = 0.0;  ///< [m^2]
  double milliseconds = 0.0;   ///< wall time of the update: a report, not an input to anything
};

/// Where to go next, and the cost-to-go there, from one planning step to the next:
///
///   FrontierPlanner frontier_planner(options);
///   const auto plan = frontier_planner.update(*belief.ground, belief.pose, belief.stamp);
///
/// plan->cost_to_go is what CostToGoTerm weighs, plan->facts what the behaviour is decided by.
///
/// Each frontier c has a utility, the area E_c that a look at it is expected to show
/// (frontier_utility.h). It is a candidate if E_c >= least_area, a path leads to one of its
/// viewpoints, and the path is worth it,
///
///     E_c / t_c >= least_rate,    t_c = path / v_max + turn_time |turn at its start| +
///                                       observation_time
///
/// The target is the first of the best sequence of candidates (frontier_order.h), if its beginning
/// is worth its path, else of those that are each; and remains so until
///   seen          its area fell below `resolved` times what it was, or below least_area;
///   unreachable   no path leads there any more;
///   no progress   the robot did not get on towards it (ProgressMonitor): its confidence is
///   lowered;
///   lost          localization was lost within the sensor's range of it, or again without progress
///   in between: likewise;
///   better        every `reconsider` seconds: another sequence is worth `commitment` more.
/// While there is none, it is asked for every reconsider / 2 seconds.
/// The reason is FrontierFacts::changed. V(p) = D(p, target) / v_max, D by the eikonal equation
/// (cost_to_go_field.h); with a feature visibility map, a metre travelled within 10 m of the robot
/// (along either axis) costs 1 + lambda max(0, 1 - N / N_req) times as much, N the features in view
/// in the direction of travel (down the field of the step before), and a viewpoint lambda
/// observation_length max(0, 1 - N / N_req) more, N in the direction of what is looked at. Both
/// count when targets are compared, too, on the path from the robot.
///
/// Nothing is given up for good but by what observations have shown: there are no retries. Where no
/// candidate is left the facts say `exhausted`; and whether some were left for their low yield,
/// whether observations have failed or the robot did not get there, whether what is left cannot be
/// reached, or only zones bar the path, which is what was asked for; and whether most places where
/// the robot has been are cut off from it by walls as drawn: an estimate that drifts can draw the
/// robot in.
///
/// A value. Thread-safety: none (one mission, one thread); what update() returns is immutable and
/// may be shared. update() never throws on a finite pose; a non-finite pose gives the last global
/// plan again. Source: formulation, section 6; order and worth are our choice, measured
/// (docs/results/frontiers.md).
class FrontierPlanner {
 public:
  /// Throws std::invalid_argument naming the option, its value and what was expected.
  explicit FrontierPlanner(const FrontierPlannerOptions& options);

  /// ground: any map; after one of another place or resolution (Traversability::continues()) the
  /// frontier planner begins anew. stamp [s], non-decreasing. attention: of the time since
  /// the last update. feature visibility map: what is seen from where, null: no localization
  /// weighting.
  std::shared_ptr<const GlobalPlan> update(const GroundMap& ground, const Pose& pose, double stamp,
                                           const FrontierActivity& activity = {},
                                           const FeatureVisibilityMap* visibility_map = nullptr,
                                           const PausePoint& pause = {});

  /// What was told lies elsewhere in W from the next update() on. Nothing that was learned is
  /// forgotten.
  void follow(const FrontierPlannerOptions& told);
  /// What was measured has moved in W (correction.h): what was learned goes with it. The map of the
  /// next update() has moved, too, and what differs there is no news.
  void follow(const PlaceMoves& moves);

  /// Whether what lies at p, in W, is to be seen: within the area, if there is one, and in no
  /// forbidden part of traversability.zones.
  bool counts(const Eigen::Vector2d& p) const;

  const Traversability& traversability() const { return traversability_; }
  const FrontierDetector& detector() const { return detector_; }
  const FrontierUtility& utility() const { return utility_; }
  const CostToGoField& field() const { return field_; }

 private:
  /// To a frontier.
  struct Path {
    double length = std::numeric_limits<double>::infinity();  // [m of path equivalent]
    double cost = std::numeric_limits<double>::infinity();    // [s] as FrontierCandidate has it
    double time = std::numeric_limits<double>::infinity();    // likewise
    Cell viewpoint;                                           // at its end
  };
  struct Closing {
    Cell at;
    double until;  // [s]
  };
  /// What ways and looks cost more where few features are in view; null where they do not.
  struct Prices {
    ViewPrice observation;
    PathPrice path;
    const Grid<float>* along = nullptr;  // of CostToGoField
    PausePoint pause{};
  };
  void take_over(const GroundMap& ground, const Pose& pose, double stamp,
                 const FrontierActivity& activity, const PausePoint& pause);
  Prices prices(const FeatureVisibilityMap* visibility_map, Cell robot, const PausePoint& pause);
  bool set_goal(int frontier, Cell robot, const Prices& prices);
  void keep_or_change_target(const Pose& pose, double stamp, const Prices& prices,
                             GlobalPlan& global_plan);
  void follow_target(double stamp, GlobalPlan& global_plan, const PausePoint& pause);
  void close(Cell at, double stamp);
  void count_along_travel(const FeatureVisibilityMap& visibility_map, Cell robot,
                          const PausePoint& pause);
  bool is_priced(Cell c) const { return along_travel_.frame.contains(c); }
  int current_target(const std::vector<Frontier>& frontiers, const PausePoint& pause) const;
  TargetChange reason_to_choose(const std::vector<Frontier>& frontiers, int current, double stamp);
  /// Whether all paths were searched.
  bool measure_paths(const Pose& pose, const std::vector<Frontier>& frontiers, int current,
                     bool all, const Prices& prices);
  void add_turn(const Pose& pose, const Frontier& frontier, Path& path) const;
  bool nothing_farther_leads(const Eigen::Vector2d& robot, const std::vector<Frontier>& frontiers,
                             double limit, const PausePoint& pause) const;
  int choose(const std::vector<Frontier>& frontiers, std::optional<int> present, bool alone,
             const Prices& prices, FrontierFacts& facts);
  std::vector<FrontierStanding> standings(const std::vector<Frontier>& frontiers, int chosen,
                                          bool searched_all, const PausePoint& pause) const;
  void summarize_unresolved(const GroundMap& ground, const Pose& pose,
                            const std::vector<Frontier>& frontiers, FrontierFacts& facts,
                            const PausePoint& pause) const;
  void fail_visit(const std::vector<Frontier>& frontiers, TargetChange why,
                  const PausePoint& pause);
  bool is_cut_off() const;
  double path_left() const;
  std::optional<Cell> narrow_ahead() const;

  FrontierPlannerOptions options_;
  Traversability traversability_;
  FrontierDetector detector_;
  FrontierUtility utility_;
  CostToGoField field_;
  PathLengths path_lengths_;     // from the robot, when the target was last chosen
  PathLengths::Search between_;  // from a frontier to others
  ProgressMonitor progress_;
  ExhaustionMonitor exhaustion_;
  Grid<float> along_travel_;           // features seen in the direction of travel, near the robot
  std::vector<Path> path_to_;          // each frontier, when the target was last chosen
  std::vector<int> order_;             // frontiers of the best sequence, likewise
  std::vector<Eigen::Vector2d> been_;  // where the robot was while it was not lost, in W [m]
  std::vector<Closing> closings_;
  bool moved_ = false;          // the map since the last update
  std::optional<Cell> target_;  // frontier cell that is led to
  // When it was chosen: E, A, E / y(A) and what was explored [m^2].
  double target_area_ = 0.0, target_gain_ = 0.0, target_expected_ = 0.0, explored_then_ = 0.0;
  double chosen_at_ = -std::numeric_limits<double>::infinity();  // [s]
  TargetChange dropped_ = TargetChange::kFirst;                  // why there is no target
  std::shared_ptr<const GlobalPlan> last_;
};

}  // namespace prospect
