// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/step_landmarks.h"

#include <utility>

#include "engine/features/landmark_selection.h"
#include "engine/features/unseen_features.h"
#include "engine/maps/usable_landmarks.h"
#include "engine/planner/step_monitors.h"
#include "models/body_transform.h"

namespace prospect {

StepLandmarks step_landmarks(const RobotDescription& robot, const PlannerParameters& p,
                             const Belief& belief, const PausePoint& pause) {
  StepLandmarks made;
  if (rests_on_features(belief)) {
    UsableLandmarks usable = usable_landmarks(belief.landmarks, pause);
    made.usable = std::move(usable.map);
    made.dropped = usable.dropped;
    made.fault = std::move(usable.fault);
    made.texture.emplace(*belief.ground, *made.usable, belief.pose.position.head<2>(),
                         LocalTextureOptions(), pause);
  } else {
    made.usable =
        std::make_shared<const LandmarkMap>(LandmarkMap{.landmarks = {}, .feature_density = 0.0});
  }
  const double reach = robot.model->max_speed() * p.N * p.dt;  // of the base, within the horizon
  const Eigen::Vector3d mount = robot.stereo_mount.T_BC.translation();
  UnseenFeatureOptions unseen;
  unseen.density = p.feature_prior ? made.usable->feature_density : 0.0;
  unseen.range = reach + p.visibility.r_max;
  unseen.height = (body_transform(belief.pose) * mount).z();
  unseen.max_blocks = p.max_landmarks / 4;
  unseen.image_cell = made.usable->image_cell;
  made.expected = unseen_features(*belief.ground, belief.pose, unseen,
                                  made.texture ? &*made.texture : nullptr, pause);
  made.mapped = select_landmarks(*made.usable, belief.pose, reach + mount.head<2>().norm(),
                                 p.max_landmarks - static_cast<int>(made.expected.size()),
                                 p.visibility, pause);
  return made;
}

}  // namespace prospect
