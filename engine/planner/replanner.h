// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/belief.h"
#include "engine/planner/return_path.h"
#include "engine/safety/plan.h"
#include "engine/task/task.h"

namespace prospect {

struct PlanningStep;

/// What a mission asks at each step: a plan from a belief. Planner is the one of this project; the
/// frontier planners it is measured against are others.
///
/// plan() and prepare() never throw, and plan() always returns an executable plan. Thread-safety:
/// one thread.
class Replanner {
 public:
  virtual ~Replanner() = default;
  /// Does the part of the next plan() that need not wait for its belief, from an earlier one, as
  /// new as there is. A robot that is driving calls it while the plan before is still being driven;
  /// then the next plan is there sooner. Nobody has to call it.
  virtual void prepare(const Belief& /*belief*/) {}
  /// Goes on with what prepare() or plan() had no time to finish, for that long at most [s], so
  /// that the next plan() goes by what is newer. Returns whether there is more to do. A robot that
  /// is driving calls it where it would wait otherwise. Never throws.
  virtual bool go_on(double /*seconds*/) { return false; }
  virtual Plan plan(const Belief& belief) = 0;
  /// The frontiers at the last plan(); null before the first, and after one that met none.
  virtual std::shared_ptr<const GlobalPlan> global_plan() const = 0;
  /// What the last plan() made besides (planning_step.h); null: it does not tell.
  virtual std::shared_ptr<const PlanningStep> step() const { return nullptr; }
  /// What to do from the next plan() on. Returns "" if it is taken, else why not, and the task
  /// stays as it was.
  virtual std::string set_task(const Task& task) {
    return task.kind == TaskKind::kExplore && !task.area
               ? ""
               : "this planner can only explore, anywhere";
  }
  /// What the path back from the belief's pose to that of the first plan() takes. None: nobody
  /// knows, or there was no plan yet. Not cheap: linear in the map.
  virtual std::optional<ReturnPath> return_path(const Belief& /*belief*/) const {
    return std::nullopt;
  }
};

}  // namespace prospect
