// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace prospect {
namespace {

// Sums of stages do not meet stamps exactly: a stage begins that much early, as a share of it.
constexpr double kRounding = 1e-9;

/// The stage in which t lies, of those in `commands` and `tail`; -1 before the first.
double stage_at(const Plan& plan, double t) {
  const double stage = (t - plan.stamp) / plan.dt + kRounding;
  return std::isfinite(stage) && plan.dt > 0.0 ? stage : std::numeric_limits<double>::infinity();
}

/// Leading stages that may be driven.
std::size_t driven(const Plan& plan) {
  return std::min(plan.commands.size(), static_cast<std::size_t>(std::max(0, plan.committed)));
}

}  // namespace

std::string_view to_string(PlanKind kind) {
  switch (kind) {
    case PlanKind::kOptimised:
      return "optimised";
    case PlanKind::kSeed:
      return "seed";
    case PlanKind::kStoppingTail:
      return "stopping tail";
  }
  return "?";
}

std::string_view to_string(PlanFault fault) {
  switch (fault) {
    case PlanFault::kNone:
      return "none";
    case PlanFault::kBelief:
      return "belief";
    case PlanFault::kMisfit:
      return "misfit";
    case PlanFault::kError:
      return "error";
    case PlanFault::kUnfinished:
      return "unfinished";
  }
  return "?";
}

std::string to_string(const Verdict& verdict) {
  switch (verdict.kind) {
    case Verdict::Kind::kNotTried:
      return "not tried";
    case Verdict::Kind::kExecuted:
      return "executed";
    case Verdict::Kind::kRefused:
      return verdict.why;
  }
  return "?";
}

Verdict verdict_named(const std::string& text) {
  for (const Verdict::Kind kind : {Verdict::Kind::kNotTried, Verdict::Kind::kExecuted}) {
    if (text == to_string(Verdict{kind})) return {kind};
  }
  return {Verdict::Kind::kRefused, text};
}

std::string_view to_string(PlanPhase phase) {
  switch (phase) {
    case PlanPhase::kBefore:
      return "before";
    case PlanPhase::kCommitted:
      return "committed";
    case PlanPhase::kTail:
      return "tail";
    case PlanPhase::kRest:
      return "rest";
  }
  return "?";
}

PlanPhase Plan::phase_at(double t) const {
  const double stage = stage_at(*this, t);
  if (stage < 0.0) return PlanPhase::kBefore;
  const auto committed_stages = static_cast<double>(driven(*this));
  if (stage < committed_stages) return PlanPhase::kCommitted;
  if (stage < committed_stages + static_cast<double>(tail.size())) return PlanPhase::kTail;
  return PlanPhase::kRest;
}

Twist Plan::command_at(double t) const {
  const PlanPhase phase = phase_at(t);
  if (phase == PlanPhase::kBefore || phase == PlanPhase::kRest) return {};
  const auto stage = static_cast<std::size_t>(stage_at(*this, t));
  const std::size_t stages = driven(*this);
  const auto command = [&](std::size_t k) -> const Twist& {
    return k < stages ? commands[k] : tail[k - stages];
  };
  const Twist& end = command(stage);
  if (!ramp_from) return end;
  const Twist& begin = stage == 0 ? *ramp_from : command(stage - 1);
  const double share = std::clamp((t - stamp) / dt - static_cast<double>(stage), 0.0, 1.0);
  return {begin.linear + share * (end.linear - begin.linear),
          begin.yaw_rate + share * (end.yaw_rate - begin.yaw_rate)};
}

}  // namespace prospect
