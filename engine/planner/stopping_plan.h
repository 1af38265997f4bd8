// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "engine/behaviour/mode.h"
#include "engine/behaviour/safety_level.h"
#include "engine/behaviour/task_kind.h"
#include "engine/maps/belief.h"
#include "engine/safety/certificate.h"
#include "engine/safety/plan.h"
#include "models/motion_model.h"

namespace prospect {

/// What the robot was about to do when it had to stop.
struct StoppedStep {
  TaskKind task = TaskKind::kExplore;
  Mode mode{};
  SafetyLevel safety_level = SafetyLevel::kNormal;
  const Plan* along = nullptr;           ///< the last certified plan; null: none
  const Certifier* certifier = nullptr;  ///< that chooses the stop, if there is a plan
};

/// The stop from the command in force, else the belief's velocity, each stage for dt [s]: what is
/// executed where nothing else can be. Not certified. It is the one that choose_stop() takes of
/// that along the last certified plan and the straight one (stop.h); the latter where the belief
/// has no place. Whatever the belief holds, the commands are finite and within limits: braking does
/// not depend on where the robot is. why: the end of a sentence. Pure.
Plan stopping_plan(const Belief& belief, const MotionModel& model, double dt,
                   const StoppedStep& step, const std::string& why);

}  // namespace prospect
