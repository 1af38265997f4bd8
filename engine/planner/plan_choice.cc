// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/plan_choice.h"

#include <utility>

#include "engine/safety/certificate.h"
#include "models/limited_twist.h"

namespace prospect {
namespace {

constexpr int kAttempts = 10;
constexpr std::size_t kReported = 5;

Eigen::MatrixXd stage_inputs(const TrajectoryBatch& t, int stages) {
  const int nu = t.horizon.nu();
  Eigen::MatrixXd inputs(nu, stages);
  for (int k = 0; k < stages; ++k) {
    for (int j = 0; j < nu; ++j) inputs(j, k) = t.u(k, j, 0);
  }
  return inputs;
}

/// States, inputs, the commands that they give, and the stop after `committed` stages. The states
/// begin with the measured velocity, however fast the robot was found to be; what it is told is
/// within its limits all the same: told its top speed, a faster base brakes as hard as it can.
void fill(const TrajectoryBatch& t, const MotionModel& model, int committed, Plan& plan) {
  const int N = t.horizon.N;
  const int nx = t.horizon.nx();
  const int nu = t.horizon.nu();
  plan.dt = t.horizon.dt;
  plan.states.clear();
  plan.inputs.clear();
  plan.commands.clear();
  plan.tail.clear();
  for (int k = 0; k <= N; ++k) {
    plan.states.emplace_back(Eigen::Map<const Eigen::VectorXd>(t.states.data() + k * nx, nx));
    if (k < N) {
      plan.inputs.emplace_back(Eigen::Map<const Eigen::VectorXd>(t.inputs.data() + k * nu, nu));
    }
  }
  for (std::size_t k = 0; k < plan.inputs.size(); ++k) {
    plan.commands.push_back(limited_twist(model, model.twist(plan.states[k + 1], plan.inputs[k])));
  }
  plan.committed = committed;
  Eigen::VectorXd x = plan.states[static_cast<std::size_t>(committed)], next(nx);
  const Eigen::MatrixXd stop =
      stopping_tail(model, x, plan.inputs[static_cast<std::size_t>(committed) - 1], plan.dt);
  for (Eigen::Index k = 0; k < stop.cols(); ++k) {
    model.step(x, stop.col(k), plan.dt, next);
    plan.tail.push_back(limited_twist(model, model.twist(next, stop.col(k))));
    x.swap(next);
  }
  if (model.num_state_constraints() > 0) {
    plan.ramp_from = limited_twist(model, model.twist(plan.states.front(), plan.inputs.front()));
  }
}

Quality quality_of(const Candidate& c) {
  if (c.result) return c.result->quality;
  return c.feasible() ? Quality::kFeasible : Quality::kInfeasible;
}

}  // namespace

bool choose_certified(const std::vector<Candidate>& candidates, const ChoiceContext& context,
                      Plan& plan) {
  const ProblemDefinition& d = context.problem.definition();
  const auto report = [&](const Candidate& c, Verdict verdict) {
    const bool always = verdict.kind == Verdict::Kind::kExecuted;
    if (plan.candidates.size() >= kReported && !always) return;
    plan.candidates.push_back(
        {c.name, c.result.has_value(), c.cost, c.violation, c.z, std::move(verdict)});
  };
  int attempts = 0;
  for (const Candidate& c : candidates) {
    const bool enough =
        attempts >= kAttempts || (attempts > 0 && context.stop() != StopRequest::kNone);
    if (plan.certified || (enough && !c.stops)) {
      report(c, {Verdict::Kind::kNotTried});
      continue;
    }
    ++attempts;
    const TrajectoryBatch t = context.problem.rollout(c.z);
    const Certificate certificate = context.certifier.certify(
        context.belief, *d.model, {d.x0, d.u_previous, stage_inputs(t, context.committed), d.dt},
        context.safety_level, context.drift);
    if (!certificate.ok()) {
      if (plan.certificate.empty()) plan.certificate = certificate.detail;
      if (plan.refused.empty() && plan.has_active_frontier) plan.refused = certificate.detail;
      report(c, {Verdict::Kind::kRefused, certificate.detail});
      continue;
    }
    report(c, {Verdict::Kind::kExecuted});
    fill(t, *d.model, context.committed, plan);
    plan.kind = c.result ? PlanKind::kOptimised : PlanKind::kSeed;
    plan.certified = true;
    plan.certificate = certificate.detail;
    plan.seed = c.name;
    plan.quality = quality_of(c);
    plan.explanation = context.problem.explain(c.z);
    plan.visible = context.visible_features.visible(t, 0);
  }
  return plan.certified;
}

}  // namespace prospect
