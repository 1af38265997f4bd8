// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/faults/injected_fault.h"
#include "engine/planner/replanner.h"
#include "models/motion_model.h"
#include "runtime/clock.h"

namespace prospect {

/// A planner that is stuck or slow, or whose plans are garbage or wrong, as injected faults say
/// (injected_fault.h); else it plans as the one that it stands for. Stuck for no longer than
/// kLongestThreadSleep, so that a mission ends.
class FaultyReplanner final : public Replanner {
 public:
  /// planner, model and clock outlive it; the time of the faults begins at `start` [s].
  FaultyReplanner(Replanner& planner, const MotionModel& model, const Clock& clock,
                  std::vector<InjectedFault> faults, double start);

  void prepare(const Belief& belief) override { planner_.prepare(belief); }
  bool go_on(double seconds) override { return planner_.go_on(seconds); }
  Plan plan(const Belief& belief) override;
  std::shared_ptr<const GlobalPlan> global_plan() const override { return planner_.global_plan(); }
  std::shared_ptr<const PlanningStep> step() const override { return planner_.step(); }
  std::optional<ReturnPath> return_path(const Belief& belief) const override {
    return planner_.return_path(belief);
  }
  std::string set_task(const Task& task) override { return planner_.set_task(task); }

 private:
  void wait() const;

  Replanner& planner_;
  const MotionModel& model_;
  const Clock& clock_;
  const std::vector<InjectedFault> faults_;
  const double start_;
};

}  // namespace prospect
