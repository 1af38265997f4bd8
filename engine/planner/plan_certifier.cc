#include "engine/planner/plan_certifier.h"

#include <algorithm>

namespace prospect {

namespace {

Certifier::Options options_for(Caution caution, const RobotDescription& robot,
                               const PlannerParameters& parameters,
                               const std::shared_ptr<const ZoneMap>& zones) {
  const CautionPolicy& rules = policy(caution);
  Certifier::Options options = Certifier::options_for(robot);
  options.zones = zones;
  options.unknown = parameters.unknown;
  options.margin = rules.margin * parameters.certificate_margin;
  if (caution == Caution::kLost) options.margin = std::max(options.margin, parameters.lost_margin);
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
  options.unknown = UnknownPolicy::kFree;
  options.margin = parameters.guard_margin();
  options.reduced_margin_share = 0.0;
  options.drift_margin = 0.0;
  return options;
}

}  // namespace

PlanCertifier::PlanCertifier(const RobotDescription& robot, const PlannerParameters& parameters,
                             const std::shared_ptr<const ZoneMap>& zones)
    : guard_(robot.shape, options_as_guard(robot, parameters, zones)) {
  for (const Caution caution : kCautions) {
    by_caution_.emplace_back(robot.shape, options_for(caution, robot, parameters, zones));
  }
}

void PlanCertifier::set_zones(const std::shared_ptr<const ZoneMap>& zones) {
  for (Certifier& certifier : by_caution_) certifier.set_zones(zones);
  guard_.set_zones(zones);
}

Certificate PlanCertifier::certify(const Belief& belief, const MotionModel& model,
                                   const PlannedMotion& motion, Caution caution,
                                   const SurfaceDrift& drift) const {
  const auto& [x0, u_previous, inputs, dt] = motion;
  const Certificate certificate = by_caution_[static_cast<std::size_t>(caution)].certify(
      belief, model, x0, u_previous, inputs, dt, policy(caution).drift ? &drift : nullptr);
  if (!certificate.ok()) return certificate;
  const Certificate guard = guard_.certify(belief, model, x0, u_previous, inputs, dt);
  return guard.ok() ? certificate : guard;
}

}  // namespace prospect
