#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adapters/simulator/injected_fault.h"
#include "engine/planner/replanner.h"
#include "runtime/clock.h"

namespace prospect {

/// A planner that is stuck or slow as injected faults say (implemented_faults()): it waits, then
/// plans as the one that it stands for. Stuck for no longer than 20 s, so that a mission ends.
class FaultyReplanner final : public Replanner {
 public:
  /// planner and clock outlive it; the time of the faults begins at `start` [s].
  FaultyReplanner(Replanner& planner, const Clock& clock, std::vector<InjectedFault> faults,
                  double start)
      : planner_(planner), clock_(clock), faults_(std::move(faults)), start_(start) {}

  void prepare(const Belief& belief) override { planner_.prepare(belief); }
  Plan plan(const Belief& belief) override {
    constexpr double kLongest = 20.0, kSlower = 0.4;  // [s]
    const double now = clock_.now(), time = now - start_;
    double wait = 0.0;
    if (const auto* stuck = fault_at(faults_, FaultSource::kPlanner, FaultVerb::kStuck, time)) {
      wait = std::min(kLongest, stuck->from + stuck->duration - time);
    } else if (fault_at(faults_, FaultSource::kPlanner, FaultVerb::kSlow, time)) {
      wait = kSlower;
    }
    if (wait > 0.0) clock_.wait_until(now + wait, {});
    return planner_.plan(belief);
  }
  std::shared_ptr<const GlobalPlan> global_plan() const override { return planner_.global_plan(); }
  std::string set_task(const Task& task) override { return planner_.set_task(task); }

 private:
  Replanner& planner_;
  const Clock& clock_;
  const std::vector<InjectedFault> faults_;
  const double start_;
};

}  // namespace prospect
