#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/clearance_field.h"
#include "engine/cost_to_go.h"
#include "engine/exploration_guide.h"
#include "engine/problem.h"

namespace prospect {

/// A start for the optimisation: one point of the problem's variables, and where it came from.
struct Seed {
  std::string name;
  Eigen::VectorXd z;
};

struct SeedContext {
  const CostToGo* cost_to_go = nullptr;  ///< non-null
  /// Where the frontiers want the robot, if anywhere.
  std::optional<FrontierTarget> target;
  /// Inputs of the previous plan from now on (nu x n, n >= 0, one column a stage).
  Eigen::MatrixXd previous;
  /// Distance to known obstacles; null: approaches keep to the cost-to-go's cells.
  const ClearanceField* clearance = nullptr;
};

/// Starts that between them reach the basins worth polishing: the shifted previous plan, the way
/// down the cost-to-go at two speeds, the same looking left and right at the end, arcs, turning in
/// place, facing the target frontier, turning then going, driving one way and looking another
/// (bases that can), and stopping.
///
/// Each is a simple steering law rolled out through the problem's own model, one decision a knot,
/// the input clamped by tracking_input and admissible_inputs, so that bounds, rate limits between
/// knots and limits on speeds hold. In a fixed order; "stop" is always among them. Deterministic.
/// Thread-safety: no state. Source: formulation, section 8; the steering laws are our choice.
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
/// drive, the last turns towards the next 0.1 m of the way, moved to the middle of gaps
/// (DescentPath::centre), before each piece of it: a gap that begins beside the robot takes that.
/// Without a target: turning in place.
std::vector<Seed> make_approach_seeds(const Problem& problem, const SeedContext& context);

}  // namespace prospect
