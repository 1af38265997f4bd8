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
  kUncommitted,  ///< the plan does not reach that far, or is not certified
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
/// newest map. Otherwise the verdict is the hardest admissible braking from the newest belief's
/// velocity, or zero if that is not finite.
///
/// check() never throws. Thread-safety: const; may be called concurrently.
/// Source: architecture, contracts; the faults it must catch are those of the fault notes.
class Guard {
 public:
  struct Options {
    double max_belief_age = 0.5;  ///< [s]
    double plan_slack = 0.3;      ///< [s] that a plan may outlive its committed part
    double tolerance = 1e-6;      ///< relative, on limits and rates
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

  std::shared_ptr<const MotionModel> model_;
  Certifier certifier_;
  Options options_;
  double linear_acceleration_ = 0.0;   // [m/s^2]
  double angular_acceleration_ = 0.0;  // [rad/s^2]
};

}  // namespace prospect
