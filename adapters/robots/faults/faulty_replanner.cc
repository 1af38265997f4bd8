// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/faulty_replanner.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace prospect {
namespace {

void fill_with(const Eigen::VectorXd& input, const Twist& command, Plan& plan) {
  for (Eigen::VectorXd& u : plan.inputs) u = input;
  for (Twist& twist : plan.commands) twist = command;
}

}  // namespace

FaultyReplanner::FaultyReplanner(Replanner& planner, const MotionModel& model, const Clock& clock,
                                 std::vector<InjectedFault> faults, double start)
    : planner_(planner), model_(model), clock_(clock), faults_(std::move(faults)), start_(start) {}

void FaultyReplanner::wait() const {
  const double now = clock_.now(), time = now - start_;
  double wait = 0.0;
  if (const auto* stuck = fault_at(faults_, FaultSource::kPlanner, FaultVerb::kStuck, time)) {
    wait = std::min(kLongestThreadSleep, stuck->from + stuck->duration - time);
  } else if (off_at_times(faults_, FaultSource::kPlanner, kOnOff, time)) {
    wait = kOnOff;
  } else if (fault_at(faults_, FaultSource::kPlanner, FaultVerb::kSlow, time)) {
    wait = kSlowPlanner;
  }
  if (wait > 0.0) clock_.wait_until(now + wait, {});
}

Plan FaultyReplanner::plan(const Belief& belief) {
  wait();
  Plan plan = planner_.plan(belief);
  const double time = clock_.now() - start_;
  if (fault_at(faults_, FaultSource::kPlanner, FaultVerb::kGarbage, time)) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    fill_with(Eigen::VectorXd::Constant(model_.nu(), kNone),
              {Eigen::Vector3d::Constant(kNone), kNone}, plan);
  } else if (fault_at(faults_, FaultSource::kPlanner, FaultVerb::kWrong, time)) {
    const Twist ahead{{model_.max_speed(), 0.0, 0.0}, 0.0};
    fill_with(model_.input(ahead), ahead, plan);
    plan.kind = PlanKind::kOptimised;
    plan.committed = static_cast<int>(plan.commands.size());
    plan.certified = true;
  }
  return plan;
}

}  // namespace prospect
