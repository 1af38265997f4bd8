// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/step_monitors.h"

#include <algorithm>

namespace prospect {

bool rests_on_features(const Belief& belief) {
  return belief.localization_source == LocalizationSource::kVisualOdometry;
}

Facts StepMonitors::update(const Belief& belief, TaskKind task, const TaskClock& clock,
                           double N_min) {
  blocked_.reset();
  if (belief.command && belief.localization != Localization::kLost) {
    blocked_ = following_.update(belief.stamp, belief.pose, *belief.command);
  } else {
    following_.reset();
  }
  localization_.update(belief.stamp, belief.localization);
  const Eigen::Vector2d position = belief.pose.position.head<2>();
  if (!began_at_) began_at_ = position;
  strayed_ = std::max(strayed_, (position - *began_at_).norm());
  Facts facts;
  facts.strayed = strayed_;
  facts.stamp = belief.stamp;
  facts.localization = belief.localization;
  facts.rests_on_features = rests_on_features(belief);
  facts.tracked = belief.tracked_features;
  facts.enough_features =
      belief.localization == Localization::kOk &&
      (!facts.rests_on_features || belief.tracked_features >= kEnoughToGoOn * N_min);
  facts.lost_for = localization_.lost_for();
  facts.not_following_at = following_.noticed_at();
  facts.task = task;
  facts.task_given_at = clock.given_at();
  if (facts.enough_features) trail_.note(position, belief.tracked_features);
  if (!trail_.places().empty()) {
    facts.tracked_at_retreat = trail_.tracked_at_newest();
    facts.retreat_distance = (trail_.places().back() - position).norm();
  }
  return facts;
}

bool StepMonitors::update_stuck(const Belief& belief, bool pursues) {
  const bool lost = belief.localization == Localization::kLost;
  return stuck_.update(belief.stamp, belief.pose.position.head<2>(), !lost && pursues);
}

void StepMonitors::follow(const PlaceMoves& moves) {
  trail_.follow(moves);
  if (began_at_) began_at_ = moves.now(*began_at_);
}

}  // namespace prospect
