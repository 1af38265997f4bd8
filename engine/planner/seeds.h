// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/behaviour/mode_policy.h"
#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/body_clearance.h"
#include "engine/maps/clearance_field.h"
#include "engine/problem/problem.h"
#include "engine/problem/stop_condition.h"

namespace prospect {

/// A start for the optimisation: one point of the problem's variables, and where it came from.
struct Seed {
  std::string name;
  Eigen::VectorXd z;
  bool stops = false;  ///< it brakes, and nothing else
};

struct SeedContext {
  const CostToGo* cost_to_go = nullptr;  ///< non-null
  /// Where the frontiers want the robot, if anywhere.
  std::optional<FrontierTarget> target;
  /// Inputs of the previous plan from now on (nu x n, n >= 0, one column a stage).
  Eigen::MatrixXd previous;
  /// Distance to known obstacles; null: approaches keep to the cost-to-go's cells.
  const ClearanceField* clearance = nullptr;
  /// Clearance to whatever is not known to be free, within which the robot must be able to stop
  /// (BrakingConstraint); null: seeds drive as fast as they may anywhere.
  const BodyClearance* known = nullptr;
  double known_margin = 0.0;  ///< of that constraint [m]
  /// Drive backwards, too: for bases that can, whose body is too long to turn everywhere.
  bool backwards = false;
  /// Once it asks to stop no more are made than one, and the one that stops.
  StopCondition stop{};
};

/// Starts that between them reach the basins worth polishing: the shifted previous plan, the path
/// down the cost-to-go at two speeds, the same looking left and right at the end, arcs, turning in
/// place, facing the target frontier, turning then going, driving one way and looking another
/// (bases that can), backing straight and down the cost-to-go (where asked for), and stopping.
///
/// Each is a simple steering law rolled out through the problem's own model, one decision a knot,
/// the input clamped by tracking_input and admissible_inputs, so that bounds, rate limits between
/// knots and limits on speeds hold. None drives faster than leaves
/// room to stop within what is known to be free, a step later: v <= a (sqrt(dt^2 + 2 d / a) - dt),
/// d the path ahead, on the arc, on which the clearance is more than the margin, a the largest
/// deceleration. A faster one would be infeasible wherever little is known, and nothing would be
/// left to begin with but standing. In a fixed order; one that stops is always among them.
/// Deterministic. Thread-safety: no state. Source: formulation, section 8; the steering laws are
/// our choice.
std::vector<Seed> make_seeds(const Problem& problem, const SeedContext& context);

/// Only those that end at the target's viewpoint, a place in known space nearby, with the target's
/// yaw, in the order in which they are tried: straight to it, the slower the nearer, then turning;
/// the same slowly; along the cost-to-go; turning only. `there` [m]: from how near on they turn.
std::vector<Seed> make_arrival_seeds(const Problem& problem, const SeedContext& context,
                                     double there);

/// Braking.
std::vector<Seed> make_stop_seeds(const Problem& problem);

/// Only those that follow the cost-to-go to the target's viewpoint and face what is to be seen from
/// there, in the order in which they are tried. Three steer while they
/// drive, the last turns towards the next 0.1 m of the path, moved to the middle of gaps
/// (DescentPath::centre), before each piece of it: a gap that begins beside the robot takes that.
/// Without a target: turning in place. Where asked for, a path backwards down the cost-to-go comes
/// before the last turn: a body that cannot turn in a passage backs out of it.
std::vector<Seed> make_approach_seeds(const Problem& problem, const SeedContext& context);

/// Those that a mode wants: one of the above. A turn is an approach without a target. `there`: of
/// make_arrival_seeds.
std::vector<Seed> make_seeds(const Problem& problem, SeedContext context, ModePolicy::Seeds wanted,
                             double there);

}  // namespace prospect
