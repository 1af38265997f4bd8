// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "engine/features/occlusion_table.h"
#include "engine/features/visibility_prediction.h"
#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/exploration_targets.h"
#include "engine/maps/body_clearance.h"
#include "engine/maps/clearance_field.h"
#include "engine/maps/ground_map.h"
#include "engine/maps/landmark_map.h"
#include "engine/maps/movers.h"
#include "engine/maps/unknown_policy.h"
#include "engine/maps/voxel_grid.h"
#include "engine/problem/problem.h"
#include "engine/problem/term_registry.h"
#include "engine/task/zone_map.h"
#include "engine/terms/clearance_constraint.h"
#include "engine/terms/exploration_gain.h"
#include "engine/terms/visible_features.h"
#include "models/robot_description.h"

namespace prospect {

/// A planning problem as plain data: all that its Problem is made of, and nothing that follows from
/// it. The planner writes one each step, problem files hold one, and make_problem() is the only way
/// from there to a Problem; so a problem that was stored is the one that was met, bit for bit (same
/// build, same machine).
///
/// Frames: everything in W unless it says otherwise. Maps are shared and never change.
/// Source: formulation, section 7.
struct ProblemSpecification {
  RobotDescription robot;
  Eigen::VectorXd x0;          ///< nx, the present state
  Eigen::VectorXd u_previous;  ///< nu, the input in force
  int N = 20;                  ///< stages
  double dt = 0.25;            ///< [s]
  int M = 10;                  ///< knots

  struct Weights {
    double control_effort = 0.0;
    double input_rate = 0.0;
    double obstacles = 0.0;
    double visible_features = 0.0;
    double exploration_gain = 0.0;  ///< of a reward: -exploration_gain in the Problem
    double cost_to_go = 0.0;
    double heading_alignment = 0.0;  ///< 0: the term is left out
  } weights;

  Eigen::VectorXd desired_input;  ///< nu; of the control effort

  std::shared_ptr<const VoxelGrid> voxels;
  std::shared_ptr<const GroundMap> ground;  ///< of the resolution of `voxels`

  // Obstacles.
  Eigen::Vector3d clearance_center = Eigen::Vector3d::Zero();  ///< of the window of both fields
  /// `obstacles` and `zones` are not used: both kinds of obstacles, and the zones below.
  ClearanceField::Options clearance_field;
  double d_safe = 0.01;                    ///< of the soft cost [m]
  double d_des = 0.25;                     ///< of the soft cost [m]
  ClearanceConstraint::Options clearance;  ///< of the hard constraint
  UnknownPolicy unknown = UnknownPolicy::kBraking;
  double unknown_d_safe = 0.01;  ///< of the constraint that `unknown` asks for [m]
  std::vector<Mover> movers{};   ///< of the soft cost, as at the time of x0
  /// Forbidden parts are obstacles to both fields; null: none.
  std::shared_ptr<const ZoneMap> zones{};

  // Visible features.
  std::vector<Landmark> landmarks;
  SensorLattice landmark_lattice;  ///< of the stereo camera
  OcclusionTable::Options landmark_occlusion;
  VisibilityParameters visibility;
  VisibleFeaturesParameters features;  ///< rho > 0: the exploration gain is the prior's surface

  // Exploration.
  ExplorationTargets targets;
  SensorLattice target_lattice;  ///< of the depth sensor
  /// Of robot.more_depth, one each.
  std::vector<SensorLattice> more_target_lattices{};
  OcclusionTable::Options target_occlusion;
  ExplorationGain::Options gain;

  std::shared_ptr<const CostToGo> cost_to_go;

  std::vector<TermUse> added_terms{};  ///< not built in, none with weight 0
  std::vector<std::string>
      terms_left_out{};  ///< built-in ones that the problem is to lack, by name
};

/// Where landmarks are [m].
std::vector<Eigen::Vector3d> positions(const std::vector<Landmark>& landmarks);

/// Distances to obstacles, of CachedEvaluators.
struct ClearanceEvaluators {
  std::shared_ptr<const ClearanceField> occupied;
  std::shared_ptr<const ClearanceField> known;      ///< null if the policy asks for none
  std::shared_ptr<const BodyClearance> body;        ///< of the robot in `occupied`
  std::shared_ptr<const BodyClearance> known_body;  ///< of the robot in `known`; null without it
};

/// What a problem is put together from. Handed on to the next step of the same robot, where what
/// has not changed need not be computed again; the result has the same bits either way.
struct CachedEvaluators : ClearanceEvaluators {
  std::shared_ptr<const OcclusionTable> landmark_table;
  std::vector<std::shared_ptr<const OcclusionTable>> target_tables;  ///< of each depth sensor
  std::shared_ptr<const VisibilityPrediction> prediction;
  std::shared_ptr<const ExplorationGain> gain;
  std::shared_ptr<const VisibleFeatures> visible_features;
  std::vector<std::shared_ptr<const Term>> added_terms;  ///< of the specification, in its order
};

/// The steps to a Problem, in this order, each on the evaluators of the one before (and,
/// where there are any, of the problem before). All throw std::invalid_argument naming the entry,
/// its value and what was expected.
void update_clearance(const ProblemSpecification& specification, ClearanceEvaluators& evaluators,
                      const PausePoint& pause = {});
void update_views(
    const ProblemSpecification& specification, CachedEvaluators& evaluators,
    OcclusionTable::Clock::time_point take_over_until = OcclusionTable::Clock::time_point::max());
void update_added_terms(const ProblemSpecification& specification, CachedEvaluators& evaluators);
std::shared_ptr<const Problem> assemble_problem(const ProblemSpecification& specification,
                                                CachedEvaluators& evaluators);

/// All of them, from nothing, and all lines of sight: evaluations then take as long the first time
/// as any other (occlusion_table.h).
std::shared_ptr<const Problem> make_problem(const ProblemSpecification& specification);

/// The same problem, bit for bit, with its maps cut down to what it looks at: the windows of the
/// clearance fields, and the box of all rays between sensor lattices and points. What is left does
/// not depend on how large the robot's map has grown. With added terms the maps stay whole: such a
/// term may look anywhere.
ProblemSpecification with_maps_cut(ProblemSpecification specification);

}  // namespace prospect
