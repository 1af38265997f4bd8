// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "engine/behaviour/safety_level.h"
#include "engine/maps/belief.h"
#include "engine/maps/surface_drift.h"
#include "engine/planner/planner.h"
#include "engine/safety/certificate.h"
#include "engine/task/zone_map.h"
#include "models/robot_description.h"

namespace prospect {

/// Inputs (nu x n, each for dt [s]) from x0, with u_previous in force before.
struct PlannedMotion {
  const Eigen::VectorXd& x0;
  const Eigen::VectorXd& u_previous;
  const Eigen::MatrixXd& inputs;
  double dt;
};

/// The certificates that a plan of a planner needs: that of the step's safety level
/// (safety_level.h), and that of the guard which checks it once more. Thread-safety: as Certifier.
class PlanCertifier {
 public:
  /// Throws std::invalid_argument as Certifier does.
  PlanCertifier(const RobotDescription& robot, const PlannerParameters& parameters,
                const std::shared_ptr<const ZoneMap>& zones);

  void set_zones(const std::shared_ptr<const ZoneMap>& zones);

  /// Checks a motion and the stop after it. drift: of the belief's surfaces; counts where the
  /// safety level minds it.
  ///
  /// What the safety level's certificate allows the guard's must, too: a start within the larger
  /// margin is checked with less of it, and may come closer to an obstacle than the guard allows
  /// later on. Without the guard's margin the two would disagree for ever.
  Certificate certify(const Belief& belief, const MotionModel& model, const PlannedMotion& motion,
                      SafetyLevel safety_level, const SurfaceDrift& drift) const;

  /// That of the guard alone: by it stops are chosen, here as there.
  const Certifier& guard() const { return guard_; }

 private:
  std::vector<Certifier> by_safety_level_;
  Certifier guard_;
};

}  // namespace prospect
