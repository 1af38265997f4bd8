// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/safety/plan.h"
#include "engine/task/task.h"

namespace prospect {

/// What changed in a map of voxels or cells since the call before.
struct MapChanges {
  static constexpr const char* kType = "prospect_msgs/msg/MapChanges";
  bool changed = false;                 ///< false: the same map, and nothing else is told
  bool whole = false;                   ///< the frame is another one: all else is unknown
  double resolution = 0.0;              ///< [m]
  std::array<std::int32_t, 6> frame{};  ///< i0, j0, width, height, k0, depth
  std::vector<std::uint32_t> runs;      ///< first index and length of each run of changes
  /// Of each place of the runs: the state (CellState); of ground cells times 2, plus 1 where it is
  /// seen through.
  std::vector<std::uint8_t> values;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("changed", m.changed);
    visit("whole", m.whole);
    visit("resolution", m.resolution);
    visit("frame", m.frame);
    visit("runs", m.runs);
    visit("values", m.values);
  }
};

/// A call of Replanner (replanner.h) with all that its result rests on, or what plan() returned.
struct PlannerCall {
  static constexpr const char* kType = "prospect_msgs/msg/PlannerCall";
  enum Kind : std::uint8_t { kPrepare = 0, kPlan = 1, kPlanned = 2, kTask = 3, kMapFrame = 4 };

  std::uint32_t sequence = 0;  ///< counts from 0; a gap: calls were dropped
  std::uint8_t kind = kPrepare;

  // kPrepare, kPlan: the belief. Of a map that is the same nothing is told again.
  std::array<double, 5> stamps{};  ///< Belief::stamp, then SourceStamps in its order [s]
  /// x, y, z, yaw; of kMapFrame those of W in the map's frame, for the beliefs after it.
  std::array<double, 4> pose{};
  std::array<double, 16> covariance{};
  std::array<double, 4> twist{};  ///< linear, yaw rate
  bool commanded = false;
  std::array<double, 4> command{};
  std::uint8_t localization = 0, source = 0;
  std::int32_t tracked = 0;
  MapChanges voxels, ground;
  bool has_landmarks = false, landmarks_changed = false;
  /// feature_density, image_cell, 1 if the noise is known, and OdometryNoise in its order.
  std::array<double, 10> landmark_map{};
  /// Threes: place of the first of the landmarks before that are kept, how many, and how many new
  /// ones follow.
  std::vector<std::uint32_t> landmark_runs;
  std::vector<std::uint64_t> landmark_ids;  ///< of the new ones
  std::vector<double> landmark_values;      ///< 19 of each new one, Landmark's members in order

  // kPlanned: what came of the kPlan before.
  std::uint64_t plan_hash = 0;  ///< plan_hash()
  double cost = 0.0;
  std::int32_t cost_evaluations = 0, gradient_evaluations = 0;

  // kTask
  std::uint8_t task = 0;
  bool has_area = false;
  /// x, y of each corner. Of kPrepare and kPlan: the stamp of the movers, if any are known, then x,
  /// y, the velocity's x, y, radius and spread of each. Of kMapFrame: how places have moved in W,
  /// for each correction that moved some (place_moves.h): how many are known, then x, y, the move's
  /// x, y, yaw, and the variance of each.
  std::vector<double> area;
  std::array<double, 5> goal{};  ///< x, y, yaw, tolerances of both
  bool has_goal_yaw = false;

  template <class Message, class Visit>
  static void fields(Message& m, Visit&& visit) {
    visit("sequence", m.sequence);
    visit("kind", m.kind);
    visit("stamps", m.stamps);
    visit("pose", m.pose);
    visit("covariance", m.covariance);
    visit("twist", m.twist);
    visit("commanded", m.commanded);
    visit("command", m.command);
    visit("localization", m.localization);
    visit("source", m.source);
    visit("tracked", m.tracked);
    visit("voxels", m.voxels);
    visit("ground", m.ground);
    visit("has_landmarks", m.has_landmarks);
    visit("landmarks_changed", m.landmarks_changed);
    visit("landmark_map", m.landmark_map);
    visit("landmark_runs", m.landmark_runs);
    visit("landmark_ids", m.landmark_ids);
    visit("landmark_values", m.landmark_values);
    visit("plan_hash", m.plan_hash);
    visit("cost", m.cost);
    visit("cost_evaluations", m.cost_evaluations);
    visit("gradient_evaluations", m.gradient_evaluations);
    visit("task", m.task);
    visit("has_area", m.has_area);
    visit("area", m.area);
    visit("goal", m.goal);
    visit("has_goal_yaw", m.has_goal_yaw);
  }
};

/// Of the bits of what a plan has the robot do: states, inputs, commands, tail, committed stages.
std::uint64_t plan_hash(const Plan& plan);

/// Makes the messages of a planner's calls, in their order. A belief costs a comparison of its maps
/// with those before. Not thread-safe.
class PlannerCallWriter {
 public:
  /// Before prepare() and plan() with that belief; none: it is as before.
  std::optional<PlannerCall> map_frame(const Belief& belief);
  PlannerCall prepare(const Belief& belief);
  PlannerCall plan(const Belief& belief);
  PlannerCall planned(const Plan& plan);
  PlannerCall task(const Task& task);

 private:
  PlannerCall belief_call(PlannerCall::Kind kind, const Belief& belief);

  std::uint32_t sequence_ = 0;
  std::shared_ptr<const MapFrame> map_frame_;
  std::shared_ptr<const VoxelGrid> voxels_;
  std::shared_ptr<const GroundMap> ground_;
  std::shared_ptr<const LandmarkMap> landmarks_;
};

/// Beliefs and tasks from messages, bit for bit, but for the octree, which is an empty one:
/// planners do not look into it. A map that did not change is the same object as before. Not
/// thread-safe.
class PlannerCallReader {
 public:
  /// Of kMapFrame.
  void take_map_frame(const PlannerCall& call, const std::string& said);
  /// Of kPrepare and kPlan. All messages are to be read, in their order. Throws InputError, which
  /// begins with `said`, for one that does not fit those before.
  Belief belief(const PlannerCall& call, const std::string& said);

 private:
  std::shared_ptr<const MapFrame> map_frame_;
  std::shared_ptr<const octomap::OcTree> octree_;
  std::shared_ptr<const VoxelGrid> voxels_;
  std::shared_ptr<const GroundMap> ground_;
  std::shared_ptr<const LandmarkMap> landmarks_;
};

/// Of kTask. Throws InputError.
Task task_of(const PlannerCall& call, const std::string& said);

}  // namespace prospect
