#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/planner/replanner.h"

namespace prospect {

/// Who listens to the calls of a planner, on its thread. All or none of them are there.
struct PlannerTap {
  std::function<void(const Belief&)> prepare;  ///< before the call
  std::function<void(const Belief&)> plan;     ///< likewise
  std::function<void(const Plan&)> planned;    ///< what came of it, unless it was cancelled
  std::function<void(const Task&)> task;       ///< before set_task(), taken or not
};

/// A planner that somebody listens to. Thread-safety: one thread.
class TappedReplanner final : public Replanner {
 public:
  /// Both outlive this.
  TappedReplanner(Replanner& planner, const PlannerTap& tap) : planner_(planner), tap_(tap) {}

  void prepare(const Belief& belief) override {
    if (tap_.prepare) tap_.prepare(belief);
    planner_.prepare(belief);
  }
  Plan plan(const Belief& belief) override {
    if (tap_.plan) tap_.plan(belief);
    Plan plan = planner_.plan(belief);
    if (tap_.planned && plan.stop != StopReason::kCancelled) tap_.planned(plan);
    return plan;
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return planner_.global_plan(); }
  std::optional<ReturnPath> return_path(const Belief& belief) const override {
    return planner_.return_path(belief);
  }
  std::string set_task(const Task& task) override {
    if (tap_.task) tap_.task(task);
    return planner_.set_task(task);
  }

 private:
  Replanner& planner_;
  const PlannerTap& tap_;
};

}  // namespace prospect
