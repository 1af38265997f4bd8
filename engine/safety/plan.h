// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/behaviour/mode.h"
#include "engine/behaviour/safety_level.h"
#include "engine/problem/solver.h"
#include "engine/task/task.h"
#include "models/types.h"

namespace prospect {

/// What a plan is made of.
enum class PlanKind {
  kOptimised,    ///< polished by the solver, certified
  kSeed,         ///< a seed scored best or the polished ones failed the certificate; certified
  kStoppingTail  ///< nothing new could be certified: braking to rest
};

std::string_view to_string(PlanKind kind);

/// Why a step made nothing but a stop. Where no candidate could be certified there is none: that is
/// a plan, too.
enum class PlanFault {
  kNone,
  kBelief,  ///< nothing can be planned from the belief: it lacks a map, or is not finite
  kMisfit,  ///< robot, parameters and the maps' resolution do not fit together (planner_fit.h)
  kError,   ///< something failed on the path
  /// Frontiers or landmarks of the first map take longer than the step's deadline: it goes on with
  /// them in the next step.
  kUnfinished
};

/// "none", "belief", "misfit", "error", "unfinished".
std::string_view to_string(PlanFault fault);

/// Wall-clock time of the parts of one planning step [ms].
struct PlanTimes {
  double frontier_planner = 0.0;  ///< frontiers and cost-to-go
  double clearance = 0.0;         ///< clearance fields
  double views = 0.0;             ///< landmark and target selection, occlusion tables
  double seeds = 0.0;             ///< making and scoring seeds
  double polish = 0.0;            ///< the solver
  double certify = 0.0;
  double total = 0.0;
};

/// How much older than the plan the beliefs are [s] that its parts are of. What a deadline leaves
/// no time to make anew is that of an earlier step; frontiers may be of prepare()'s belief, too. 0:
/// of the plan's own. All other parts, the views and the certificate among them, are always its
/// own.
struct PlanAge {
  double landmarks = 0.0;    ///< that were chosen, and the texture around
  double global_plan = 0.0;  ///< frontiers, or the path to the goal, and the cost-to-go
  double clearance = 0.0;    ///< distances to obstacles of the problem
};

/// What became of a candidate.
struct Verdict {
  enum class Kind { kNotTried, kExecuted, kRefused };
  Kind kind = Kind::kNotTried;
  std::string why{};  ///< if refused: what the certificate said
};

/// "not tried", "executed", or why it was refused.
std::string to_string(const Verdict& verdict);
/// What to_string() gives of it.
Verdict verdict_named(const std::string& text);

/// One of the best candidates of a planning step, and what became of it.
struct PlanCandidate {
  std::string name;       ///< of the seed
  bool polished = false;  ///< by the solver
  double cost = 0.0;      ///< its lower bound, if only scored
  double violation = 0.0;
  Eigen::VectorXd z;  ///< the problem's variables
  Verdict verdict;
};

/// Where in a plan a time lies.
enum class PlanPhase {
  kBefore,     ///< it has not begun
  kCommitted,  ///< in the certified part, or in a stopping tail
  kTail,       ///< in the stop after it
  kRest        ///< after all of it
};

std::string_view to_string(PlanPhase phase);

/// One planning step's result. Always executable: `commands` are finite, within the model's limits
/// and either certified or a stop.
struct Plan {
  PlanKind kind = PlanKind::kStoppingTail;
  PlanFault fault = PlanFault::kNone;  ///< `detail` tells more
  double stamp = 0.0;  ///< [s], of the belief it starts from: its first stage begins then
  double dt = 0.25;    ///< [s], duration of each command
  std::vector<Eigen::VectorXd> states;  ///< x_0 ... x_N
  std::vector<Eigen::VectorXd> inputs;  ///< u_0 ... u_{N-1}
  std::vector<Twist> commands;          ///< body velocity to hold over each stage
  /// The certified stop after the committed part: body velocities to hold for dt each, the last one
  /// rest. Empty for a stopping tail, whose commands are the stop.
  std::vector<Twist> tail;
  /// Of a base that is controlled by acceleration, its velocity at `stamp`: from there on the
  /// velocity changes linearly over each stage and arrives at the stage's command. None: it is the
  /// stage's command from the stage's start on.
  std::optional<Twist> ramp_from;
  std::vector<double> visible;  ///< N_k predicted at k = 0 ... N; empty without landmarks
  int committed = 0;            ///< leading stages that are certified, with the stop after them

  bool certified = false;
  std::string certificate;  ///< what the certificate said
  /// Why it refused the first candidate that it refused, though there was somewhere to go; empty:
  /// it did not.
  std::string refused;
  std::string seed;  ///< name of the seed the plan grew from
  std::string solver;
  StopReason stop = StopReason::kConverged;
  Quality quality = Quality::kNone;
  Explanation explanation;  ///< every term, raw and weighted
  Counters counters;
  int seeds_scored = 0;          ///< that could be evaluated before the deadline
  double features_weight = 0.0;  ///< w_l in this step (feature_weight.h)
  PlanTimes times;

  TaskKind task = TaskKind::kExplore;               ///< what it was told to do
  std::optional<Goal> goal;                         ///< of that, if it leads to a place
  Mode mode;                                        ///< what the robot does, and why
  SafetyLevel safety_level = SafetyLevel::kNormal;  ///< which distances it keeps
  std::string why;                                  ///< the same in a sentence, with numbers
  /// [rad] left to the heading of the goal that it has reached, where that cannot be had.
  std::optional<double> heading_missed;
  /// The best five, and the one executed, in the order in which they were to be tried.
  std::vector<PlanCandidate> candidates;

  bool has_active_frontier = false;  ///< some active frontier is reachable
  PlanAge age;                       ///< of what is not made from its belief; `why` tells it, too
  std::string detail;                ///< why it is a stop, in one sentence
  /// Landmarks of the belief that could not be used and were left out, and the first fault of the
  /// landmark map, empty if there is none (usable_landmarks.h).
  int landmarks_dropped = 0;
  std::string landmark_fault;

  PlanPhase phase_at(double t) const;
  /// The body velocity at time t [s] of the clock of `stamp`: in the committed part that of the
  /// stage, past it that of the stop, past that, before the plan has begun, and where t is not
  /// finite, rest. So a plan that nobody replaces never drives on.
  Twist command_at(double t) const;
};

}  // namespace prospect
