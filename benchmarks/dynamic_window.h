// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/frontiers/cost_to_go.h"
#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/body_clearance.h"
#include "models/motion_model.h"

namespace prospect {

struct DynamicWindowOptions {
  double dt = 0.25;               ///< [s], duration of a stage
  int stages = 7;                 ///< horizon of a rollout
  double lookahead = 0.6;         ///< [m] along the path, from the point nearest to the robot
  double path_length = 4.0;       ///< [m] of path looked at
  double heading_weight = 0.7;    ///< of the time that turning into the path would take
  double clearance_weight = 1.0;  ///< [s] charged where the clearance is d_safe throughout
  double d_safe = 0.04;           ///< hard clearance [m]
  double lattice_slack = 0.02;    ///< by which cells of the path may fall short of d_safe [m]
  double d_des = 0.25;            ///< clearance beyond which closeness costs nothing [m]
};

/// One motion that the driver considered.
struct DriveCandidate {
  std::string name;
  Eigen::MatrixXd inputs;  ///< nu x stages
  double cost = 0.0;       ///< [s]
  bool stops = false;      ///< it brakes, and nothing else
};

struct DriveTask {
  Eigen::VectorXd x0;                    ///< nx
  Eigen::VectorXd u_previous;            ///< nu, the input in force
  const CostToGo* cost_to_go = nullptr;  ///< non-null
  std::optional<FrontierTarget> target;  ///< where to look in the end; none: look around
  bool escape = false;                   ///< stuck: only get away from the obstacles
  bool arrived = false;                  ///< at the viewpoint: turn towards what is to be seen
};

/// Local driver of the frontier planners: rolls out 8 constant speeds x 15 turn rates (within the
/// window that the rate limits leave, for they clamp every stage), pure pursuit of the path with
/// two lookaheads at four speeds, slowing down towards its end, turning towards the path, and
/// stopping, all through the robot's own model, and orders them by
///
///   V(p_T) + heading_weight |angle to the path's direction at p_T| / omega_max
///     + clearance_weight mean_k max(0, (d_des - d_k) / (d_des - d_safe))^2
///     + 60 s/m max_k max(0, min(d_safe - lattice_slack, d_0) - d_k),
///
/// V the cost-to-go [s], d_k the body's clearance at stage k [m]. V(p_T) is the time that is left
/// after the horizon, so with one horizon for all the order is by time to the viewpoint. At the end
/// of the path the heading is free. To escape, only turning and driving along the gradient of the
/// clearance are considered, the fastest first. Once arrived, only turning towards the target and
/// stopping are. Best first; one that stops is always among them. Deterministic. Thread-safety: no
/// state. Source: the dynamic window approach (Fox, Burgard, Thrun 1997) with a global cost-to-go
/// instead of a goal heading (Brock, Khatib 1999); weights are our choice.
std::vector<DriveCandidate> dynamic_window(const MotionModel& model, const BodyClearance& body,
                                           const DriveTask& task,
                                           const DynamicWindowOptions& options);

}  // namespace prospect
