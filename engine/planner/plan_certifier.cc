// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/plan_certifier.h"

#include <algorithm>

namespace prospect {

namespace {

Certifier::Options options_for(SafetyLevel safety_level, const RobotDescription& robot,
                               const PlannerParameters& parameters,
                               const std::shared_ptr<const ZoneMap>& zones) {
  const SafetyLevelPolicy& rules = policy(safety_level);
  Certifier::Options options = Certifier::options_for(robot);
  options.zones = zones;
  options.seen_floor = parameters.unseen_floor == UnseenFloor::kBlocked;
  options.step = parameters.step;
  options.unknown = parameters.unknown;
  options.margin = rules.margin * parameters.certificate_margin;
  if (safety_level == SafetyLevel::kLost)
    options.margin = std::max(options.margin, parameters.lost_margin);
  options.reduced_margin_share = rules.reduced_margin_share;
  options.drift_limit = parameters.drift_limit;
  options.drift_margin = rules.drift_margin ? parameters.drift_margin : 0.0;
  return options;
}

Certifier::Options options_as_guard(const RobotDescription& robot,
                                    const PlannerParameters& parameters,
                                    const std::shared_ptr<const ZoneMap>& zones) {
  Certifier::Options options = Certifier::options_for(robot);
  options.zones = zones;
  options.seen_floor = parameters.unseen_floor == UnseenFloor::kBlocked;
  options.step = parameters.step;
  options.unknown = UnknownPolicy::kFree;
  options.known_ground = parameters.unknown != UnknownPolicy::kFree;
  options.margin = parameters.guard_margin();
  options.reduced_margin_share = 0.0;
  options.drift_margin = 0.0;
  return options;
}

}  // namespace

PlanCertifier::PlanCertifier(const RobotDescription& robot, const PlannerParameters& parameters,
                             const std::shared_ptr<const ZoneMap>& zones)
    : guard_(robot.shape, options_as_guard(robot, parameters, zones)) {
  for (const SafetyLevel safety_level : kSafetyLevels) {
    by_safety_level_.emplace_back(robot.shape, options_for(safety_level, robot, parameters, zones));
  }
}

void PlanCertifier::set_zones(const std::shared_ptr<const ZoneMap>& zones) {
  for (Certifier& certifier : by_safety_level_) certifier.set_zones(zones);
  guard_.set_zones(zones);
}

Certificate PlanCertifier::certify(const Belief& belief, const MotionModel& model,
                                   const PlannedMotion& motion, SafetyLevel safety_level,
                                   const SurfaceDrift& drift) const {
  const auto& [x0, u_previous, inputs, dt] = motion;
  const Certificate certificate = by_safety_level_[static_cast<std::size_t>(safety_level)].certify(
      belief, model, x0, u_previous, inputs, dt, policy(safety_level).drift ? &drift : nullptr);
  if (!certificate.ok()) return certificate;
  const Certificate guard = guard_.certify(belief, model, x0, u_previous, inputs, dt);
  return guard.ok() ? certificate : guard;
}

}  // namespace prospect
