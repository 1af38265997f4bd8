// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "engine/behaviour/task_kind.h"
#include "engine/maps/localization.h"

namespace prospect {

/// Why the target is another than at the step before.
enum class TargetChange {
  kNone,         ///< it is the same
  kFirst,        ///< there was none
  kSeen,         ///< it has shown what there was
  kUnreachable,  ///< no path leads there any more
  kNoProgress,   ///< the robot did not get on towards it
  kLost,         ///< the path there cost the robot its localization
  kBetter        ///< another is worth more by far
};

/// "", "first", "seen", "unreachable", "no progress", "lost", "better".
std::string_view to_string(TargetChange change);

/// Frontiers that are not gone to.
struct FrontiersLeft {
  int count = 0;
  double area = 0.0;  ///< that they promise [m^2]
};

/// What the frontiers say, once they are up to date.
struct FrontierFacts {
  bool target = false;         ///< one of them is gone to
  double target_length = 0.0;  ///< of that frontier [m]
  double target_area = 0.0;    ///< that a look at it is expected to show [m^2]
  double path_left = 0.0;      ///< [m] to its viewpoint, down the cost-to-go
  TargetChange changed = TargetChange::kNone;
  bool narrow = false;         ///< the next metres of the path are narrow (Traversability::narrow)
  double stalled_for = 0.0;    ///< [s] without progress towards it (ProgressMonitor)
  bool stalled = false;        ///< ... for long, and nothing new was seen of it since
  bool exhausted = false;      ///< no frontier that can be reached is worth its path
  double exhausted_for = 0.0;  ///< [s] that this has been so while the robot looked for one
  bool cut_off = false;        ///< if exhausted: from most places the robot came through
  double explored_area = 0.0;  ///< [m^2] seen so far
  /// If exhausted: reachable, but too little for the path; no path leads there; promising, but
  /// looks have shown nothing; promising, but given up on the path there; only zones bar the path.
  FrontiersLeft low_yield{}, unreachable{}, failed{}, given_up{}, barred{};
  std::string barred_by{};  ///< if barred.count > 0: the zone
  /// The target is the area that is to be explored: none of it can be seen from what is known, and
  /// a path leads there through unknown space.
  bool to_area = false;
  double unknown_left = 0.0;  ///< if to_area: [m] of path_left
  bool hemmed_in = false;     ///< if exhausted: no place within 1 m of the robot is passable
  /// If exhausted, and an area is to be explored: nothing free of it was seen.
  bool area_unseen = false;
  std::string area_why{};  ///< if exhausted: why no path leads to what is unknown of the area
};

/// What is known of the path to a goal, once it is up to date (GoalPlanner).
struct GoalFacts {
  bool reached = false;          ///< the pose is within the goal's tolerances
  bool near = false;             ///< a known path of no more than GoalPlanner::kNear is left
  double distance = 0.0;         ///< [m] to it, as the crow flies
  double path_left = 0.0;        ///< [m] to it, down the cost-to-go
  double unknown_left = 0.0;     ///< [m] of that through unknown space
  double stalled_for = 0.0;      ///< [s] without progress towards it (GoalMonitor)
  bool stalled = false;          ///< ... for long
  bool unreachable = false;      ///< no path leads there
  double unreachable_for = 0.0;  ///< [s] that this has been so
  std::string why{};             ///< if unreachable, as the end of a sentence
  /// [rad] that is left to its heading, where that cannot be had (HeadingMonitor): the place
  /// counts.
  std::optional<double> heading_missed{};
  std::string heading_why{};  ///< then, as the end of a sentence
};

/// What is known at one instant of what the robot's behaviour depends on. No judgement: monitors
/// and maps report, decide() (behaviour.h) judges. Stamps in the belief's clock [s].
struct Facts {
  double stamp = 0.0;
  Localization localization = Localization::kOk;
  bool rests_on_features = true;  ///< localization is visual odometry, not the robot's own
  int tracked = 0;                ///< features in the newest image
  bool enough_features = true;    ///< localization is ok, and enough are tracked to go on
  double lost_for = 0.0;          ///< [s] since localization was not lost; 0 if it is not
  int tracked_at_retreat = 0;     ///< features at the newest place where enough were tracked
  double retreat_distance = 0.0;  ///< [m] from there, as the crow flies; 0 without such a place
  std::optional<double> not_following_at{};  ///< when last noticed (FollowingMonitor)
  bool stuck = false;                        ///< it tries to get on and does not (StuckMonitor)
  double strayed = 0.0;                      ///< [m] the farthest it has been from where it began
  std::string
      refused{};  ///< newest reason of the certificate not to drive to a target; empty: none
  TaskKind task = TaskKind::kExplore;                               ///< what it is told to do
  double task_given_at = -std::numeric_limits<double>::infinity();  ///< first stamp with it [s]
  std::optional<GoalFacts> goal{};  ///< of tasks that lead to a place; none until up to date
  /// Of the task to explore. None until they are up to date: what comes before them in the table is
  /// decided without.
  std::optional<FrontierFacts> frontiers{};
};

}  // namespace prospect
