// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "engine/safety/guard.h"
#include "models/motion_model.h"

namespace prospect::test {

/// Of a cylinder, with beliefs up to two seconds old: tests share their machine.
inline Guard patient_guard(std::shared_ptr<const MotionModel> model) {
  Certifier::Options certifier;
  certifier.slice = {0.1, 0.5};
  Guard::Options options;
  options.max_belief_age = options.max_pose_age = options.max_map_age = 2.0;
  options.max_landmarks_age = options.max_ranges_age = 2.0;
  return Guard(std::move(model), CylinderShape{}, certifier, options);
}

}  // namespace prospect::test
