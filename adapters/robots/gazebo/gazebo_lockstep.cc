// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_lockstep.h"

#include <utility>
#include <variant>

#include "runtime/mission_observer.h"

namespace prospect {

GazeboLockstep::GazeboLockstep(SteppedGazebo& gazebo, PerceptionPipeline& perception)
    : gazebo_(gazebo), perception_(perception) {
  apply({}, 0.5);
}

CameraPicture GazeboLockstep::picture() {
  if (!left_) return {};
  return {left_, perception_.odometry().sightings()};
}

void GazeboLockstep::apply(const Twist& command, double duration) {
  SteppedGazebo::Told told;
  told.frame = [this](const SensorFrame& frame) {
    tell(observers_, &MissionObserver::on_frame, frame);
    if (const auto* pair = std::get_if<StereoFrame>(&frame)) left_ = pair->left;
    feed(perception_, frame);
  };
  told.pose = [this](double stamp, const Pose& pose) { truth_.push_back({stamp, pose}); };
  gazebo_.advance(command, gazebo_.time() + duration, told);
}

void GazeboLockstep::watched_by(std::vector<MissionObserver*> observers) {
  observers_ = std::move(observers);
}

std::deque<GazeboTruth::Stamped> GazeboLockstep::take_truth() { return std::exchange(truth_, {}); }

}  // namespace prospect
