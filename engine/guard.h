#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "engine/belief.h"
#include "engine/certificate.h"
#include "engine/plan.h"
#include "models/motion_model.h"

namespace prospect {

enum class GuardReason {
  kPassed,
  kNonFinite,    ///< the command, the pose or the velocity is not finite
  kLimit,        ///< faster than the model allows
  kRate,         ///< a larger change of velocity than the model allows
  kStale,        ///< the belief or the plan is too old, or from the future
  kUncommitted,  ///< the plan does not reach that far, is not certified, does not belong to its
                 ///< commands, or is a stop that does not slow down
  kMap           ///< the newest map forbids what was certified against an older one
};

std::string_view to_string(GuardReason reason);

/// What the motors get.
struct GuardVerdict {
  Twist command;  ///< finite and within limits, whatever was asked for
  GuardReason reason = GuardReason::kPassed;
  std::string detail;
  bool passed() const { return reason == GuardReason::kPassed; }
};

/// The last gate before the motors. A command passes only if it is finite, within limits and rates,
/// fresh, and its plan's remaining committed part, with the stop after it, is certified against the
/// newest map; the command must be the one that the certified inputs give. Otherwise the verdict is
/// the hardest admissible braking from the command in force, or zero if that is not finite. A
/// stopping tail needs no certificate; it passes as long as it slows down.
///
/// check() never throws; the constructor throws std::invalid_argument without a model or with a
/// shape or options that Certifier refuses. Thread-safety: const; may be called concurrently.
/// Source: architecture, contracts; the faults it must catch are those of the fault notes.
class Guard {
 public:
  struct Options {
    double max_belief_age = 0.5;  ///< [s]
    double plan_slack = 0.3;      ///< [s] that a plan may outlive its committed part
    double tolerance = 1e-6;      ///< relative, on limits and rates
    /// Share of the largest speeds by which a command may differ from what its input gives from the
    /// newest pose, for bases controlled by acceleration: their body velocity turns with the
    /// estimated yaw.
    double mismatch = 0.1;
  };

  Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
        const Certifier::Options& certificate, Options options);
  Guard(std::shared_ptr<const MotionModel> model, const RobotShape& shape,
        const Certifier::Options& certificate)
      : Guard(std::move(model), shape, certificate, Options()) {}

  /// May plan.commands[stage] be sent at time `now` [s], given the newest belief and the command in
  /// force before it?
  GuardVerdict check(const Plan& plan, int stage, const Twist& previous, const Belief& newest,
                     double now) const;

 private:
  GuardVerdict stop(GuardReason reason, const std::string& detail, const Twist& previous,
                    const Belief& newest, double dt) const;
  bool within_rates(const Twist& command, const Twist& previous, double dt) const;

  std::shared_ptr<const MotionModel> model_;
  Certifier certifier_;
  Options options_;
  double linear_acceleration_ = 0.0;   // [m/s^2]
  double angular_acceleration_ = 0.0;  // [rad/s^2]
};

}  // namespace prospect
