// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "adapters/views/page/landmark_picture.h"
#include "engine/behaviour/facts.h"
#include "engine/behaviour/mode.h"
#include "engine/behaviour/safety_level.h"
#include "engine/behaviour/task_kind.h"
#include "engine/frontiers/frontier_standing.h"
#include "engine/maps/grid.h"
#include "engine/maps/localization.h"
#include "engine/maps/movers.h"
#include "engine/problem/solver.h"
#include "engine/safety/guard.h"
#include "engine/safety/plan.h"
#include "engine/task/polygon.h"
#include "engine/task/zones.h"
#include "models/types.h"
#include "runtime/mission_end.h"

namespace prospect {

/// A landmark as the report draws it.
struct LandmarkView {
  float x = 0.0F, y = 0.0F;  ///< [m], estimated frame
  float visibility = 0.0F;   ///< probability that it is visible now
};

/// Where the frontiers want the robot.
struct TargetRecord {
  Eigen::Vector2d viewpoint = Eigen::Vector2d::Zero();  ///< estimated frame [m]
  Eigen::Vector2d looks_at = Eigen::Vector2d::Zero();   ///< a frontier cell seen from there [m]
  double length = 0.0;                                  ///< of the frontier [m]
  double area = 0.0;       ///< [m^2] that a look at it is expected to show
  double path_left = 0.0;  ///< [m] to the viewpoint
};

/// A frontier when it was asked which is next (FrontierStanding).
struct FrontierRecord {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< its centroid, estimated frame [m]
  FrontierStanding::Why why = FrontierStanding::Why::kLater;
  double area = 0.0;                      ///< E: that a look at it is expected to show [m^2]
  double unknown = 0.0;                   ///< A: unknown ground that a look at it may show [m^2]
  double time = FrontierStanding::kNone;  ///< until it has been looked at [s]; kNone: no path known
};

/// The factor of a cost in the objective of a step; negative: a reward. The cost of the step is the
/// sum of in_effect times raw value over its costs.
struct TermWeight {
  std::string name;
  double asked = 0.0;      ///< as configured
  double in_effect = 0.0;  ///< as it was scaled for the step
};

/// One of the best candidates of a step.
struct CandidateRecord {
  std::string name;       ///< of the seed
  bool polished = false;  ///< by the solver
  Verdict verdict;
  Explanation explanation;            ///< cost and every term
  std::vector<Eigen::Vector2f> path;  ///< positions over the horizon, estimated frame [m]
};

/// Ground cells along a side of a cell of a CostToGoPicture.
inline constexpr int kCostToGoCoarser = 2;

/// The cost-to-go around the robot.
struct CostToGoPicture {
  GridFrame frame;
  std::vector<float> seconds;  ///< by cell, as in Grid; NaN: unknown or impassable there
};

/// Where the map's frame is (engine/maps/correction.h).
struct MapFrameRecord {
  Pose origin;      ///< of W, in the map's frame
  int taken = 0;    ///< corrections so far
  int refused = 0;  ///< likewise, and those that cannot be followed
  // Of those since the step before; the newest of several. None: there are none.
  std::optional<double> distance{}, turn{};  ///< [m] that the robot moved in the map, [rad]
  std::string why{};
};

/// Everything recorded at one planning step. All numbers but those in `wall` are reproducible. What
/// is told of it, and by which name: step_fields.h. A word is none where a record was read that
/// lacks it.
struct StepRecord {
  int step = 0;
  double time = 0.0;   ///< [s] of the robot's clock since the start
  double stamp = 0.0;  ///< [s] of the clock of beliefs
  Pose true_pose, estimated_pose;
  Twist command;  ///< the first one of the plan
  std::optional<PlanKind> plan_kind;
  std::string seed;                 ///< which seed the plan grew from
  Explanation explanation;          ///< cost and every term, raw and weighted
  std::vector<TermWeight> weights;  ///< of its costs; empty: not known
  double predicted_features = 0.0;  ///< N_k predicted for the end of the committed part
  int tracked_features = 0;         ///< in the newest image
  std::optional<Localization> localization;
  double coverage = 0.0;            ///< share of the reachable area; NaN: there is none
  double area = 0.0;                ///< [m^2] of the reachable area really seen
  double localization_error = 0.0;  ///< [m]
  double path_length = 0.0;         ///< [m] really driven
  int collisions = 0;               ///< so far
  double clearance = 0.0;  ///< [m], smallest along the plan; from the clearance term's raw value
  int cost_evaluations = 0;
  int gradient_evaluations = 0;
  std::optional<StopReason> stop_reason;
  std::optional<Quality> quality;
  bool certified = false;
  std::string certificate;
  int active_frontiers = 0;
  /// Those that are next and how many are not, and why; empty if it was not asked
  /// (FrontierStanding)
  std::string frontiers;
  int guard_stops = 0;
  std::optional<GuardReason> guard_reason;  ///< of the last of them; none: there are none

  std::optional<MapFrameRecord> map_frame{};  ///< none: nobody corrects it

  std::optional<TaskKind> task;             ///< what it was told to do
  std::optional<Eigen::Vector2d> goal{};    ///< of a task that leads to a place, in W [m]
  std::optional<double> goal_yaw{};         ///< [rad]; none: any
  std::optional<ModeKind> mode;             ///< what the robot does
  std::optional<Cause> cause;               ///< why it began to
  double mode_since = 0.0;                  ///< [s] of the robot's clock since the start
  std::optional<SafetyLevel> safety_level;  ///< which distances it keeps
  std::optional<TargetChange> target_change;
  std::string why;  ///< one sentence: what it does and why, with the numbers of this step
  std::optional<TargetRecord> target;
  int seeds_scored = 0;
  double features_weight = 0.0;               ///< w_l in effect
  std::vector<CandidateRecord> candidates;    ///< at most six, best first
  std::optional<CostToGoPicture> cost_to_go;  ///< at some of the steps

  std::vector<Pose> horizon;  ///< predicted poses x_0 ... x_N, estimated frame
  std::vector<Eigen::Vector2f>
      frontier_cells;  ///< centres of active frontier cells, estimated frame
  /// Of a step that asked which frontier is next: all active ones, those of the sequence in its
  /// order, then the others by area.
  std::vector<FrontierRecord> standings{};
  std::vector<LandmarkView> landmarks;  ///< those the planner considered
  std::vector<Mover> movers{};          ///< as predicted for `stamp`, estimated frame
  /// Ground cells whose state changed since the previous record.
  std::vector<std::pair<Cell, CellState>> map_changes;

  /// Wall-clock times, the only entries that differ between two runs of one seed [ms].
  struct Wall {
    double plan = 0.0, frontier_planner = 0.0, clearance = 0.0, views = 0.0, seeds = 0.0,
           polish = 0.0, certify = 0.0;
  } wall;
  PlanAge age;  ///< of what the plan took from earlier beliefs
};

/// Results of a whole mission; the names are those of summary.json. NaN: never reached, or a share
/// of nothing.
struct Summary {
  std::string world, solver;
  std::uint64_t seed = 0;
  MissionEnd end =
      MissionEnd::kLogEndsEarly;  ///< "reason" is its name, "outcome" that of outcome()
  std::string task;               ///< that it began with: to_string(TaskKind)
  bool done = false;   ///< the task was done, and the robot is back if it was told to return
  std::string detail;  ///< one or two sentences
  /// Of a mission that was to return: when it turned back for want of time [s], else NaN.
  double turned_back_s = std::numeric_limits<double>::quiet_NaN();
  /// Left to the heading that was asked for, of a goal whose heading cannot be had [degrees]; NaN:
  /// it was had, or none was asked for.
  double heading_missed_deg = std::numeric_limits<double>::quiet_NaN();
  double coverage = 0.0;
  double area_m2 = 0.0;  ///< of the reachable area seen
  double reachable_area_m2 = 0.0;
  double too_long_for_m2 = 0.0;  ///< ReachableArea::too_long_for
  bool measured = true;          ///< somebody knew what is true; else collisions say nothing
  int collisions = 0;
  int losses = 0;
  double duration_s = 0.0;
  double wall_s = 0.0;
  double path_length_m = 0.0;
  double time_to_90_s = 0.0, time_to_95_s = 0.0, time_to_99_s = 0.0;
  double path_to_90_m = 0.0, path_to_95_m = 0.0, path_to_99_m = 0.0;
  double localization_rmse_m = 0.0, localization_final_m = 0.0, drift_percent = 0.0;
  double plan_ms_p50 = 0.0, plan_ms_p95 = 0.0, plan_ms_p99 = 0.0, plan_ms_max = 0.0;
  int deadline_misses = 0;
  int fallbacks = 0;
  int guard_stops = 0;
  int steps = 0;
  /// World::floor_share: what share of the ground in the world's file the robot explores on.
  double floor_share = std::numeric_limits<double>::quiet_NaN();
  std::string read_without;  ///< World::left_out; empty: nothing
};

/// That of its end, but for a task that is done the robot must be back if it was told to return
/// (else kNotDone), and have touched nothing (else kFailed). What speaks of success (exit code,
/// colours) asks for this.
Outcome outcome(const Summary& summary);

/// A whole run as the report needs it.
struct RunRecord {
  Summary summary;
  double resolution = 0.1;  ///< of the ground cells [m]
  double robot_radius = 0.2;
  double sensor_range = 4.0;
  double sensor_fov = 1.2;
  Zones zones;
  std::optional<Polygon> area;  ///< to explore; none: all
  std::vector<StepRecord> steps;
  /// Of a robot with cameras: what they showed at some of the steps, evenly spread.
  std::vector<LandmarkPicture> pictures;
  std::string configuration;  ///< effective, as YAML
};

}  // namespace prospect
