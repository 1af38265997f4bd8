// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/features/local_texture.h"
#include "engine/maps/belief.h"
#include "engine/planner/planner.h"
#include "engine/support/resumable.h"

namespace prospect {

/// What a step takes of the landmarks that a belief knows, however many those are.
struct StepLandmarks {
  std::shared_ptr<const LandmarkMap> usable;  ///< usable_landmarks(); never null
  int dropped = 0;
  std::string fault;  ///< of the landmark map
  /// Of what is seen nearby; none where the localization does not rest on it.
  std::optional<LocalTexture> texture;
  std::vector<Landmark> expected;  ///< in unknown ground (unseen_features.h)
  std::vector<Landmark> mapped;    ///< that stand for all within reach (landmark_selection.h)
};

/// Of a robot whose localization does not rest on landmarks: none known, none expected. The belief
/// has its other maps and a finite pose. Cost: linear in the landmarks. Deterministic. Passes on
/// what the maps throw. Thread-safety: pure.
StepLandmarks step_landmarks(const RobotDescription& robot, const PlannerParameters& parameters,
                             const Belief& belief, const PausePoint& pause = {});

}  // namespace prospect
