#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "engine/solver.h"
#include "models/types.h"

namespace prospect {

/// What a plan is made of.
enum class PlanKind {
  kOptimised,     ///< polished by the solver, certified
  kSeed,          ///< a seed scored best or the polished ones failed the certificate; certified
  kStoppingTail,  ///< nothing new could be certified: braking to rest
  kRecovery,  ///< localization is lost or degraded: turning or retreating to where features are;
              ///< or the robot does not follow its commands: turning away
  kScripted   ///< the stall watchdog's go-and-face
};

std::string_view to_string(PlanKind kind);

/// Wall-clock time of the parts of one planning step [ms].
struct PlanTimes {
  double guide = 0.0;      ///< frontiers and cost-to-go
  double clearance = 0.0;  ///< clearance fields
  double views = 0.0;      ///< landmark and target selection, occlusion tables
  double seeds = 0.0;      ///< making and scoring seeds
  double polish = 0.0;     ///< the solver
  double certify = 0.0;
  double total = 0.0;
};

/// One planning step's result. Always executable: `commands` are finite, within the model's limits
/// and either certified or a stop.
struct Plan {
  PlanKind kind = PlanKind::kStoppingTail;
  double stamp = 0.0;                   ///< [s], of the belief it starts from
  double dt = 0.25;                     ///< [s], duration of each command
  std::vector<Eigen::VectorXd> states;  ///< x_0 ... x_N
  std::vector<Eigen::VectorXd> inputs;  ///< u_0 ... u_{N-1}
  std::vector<Twist> commands;          ///< body velocity to hold over each stage
  std::vector<double> visible;          ///< N_k predicted at k = 0 ... N; empty without landmarks
  int committed = 0;  ///< leading stages that are certified, with the stop after them

  bool certified = false;
  std::string certificate;  ///< what the certificate said
  std::string seed;         ///< name of the seed the plan grew from
  std::string solver;
  StopReason stop = StopReason::kConverged;
  Quality quality = Quality::kNone;
  Explanation explanation;  ///< every term, raw and weighted
  Counters counters;
  int seeds_scored = 0;
  PlanTimes times;

  bool has_active_frontier = false;  ///< some active frontier is reachable
  std::string detail;                ///< why, in one sentence
};

}  // namespace prospect
