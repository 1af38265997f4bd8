// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_truth.h"
#include "adapters/robots/gazebo/stepped_gazebo.h"
#include "perception/pipeline/perception_pipeline.h"
#include "runtime/lockstep_robot.h"

namespace prospect {

/// A robot in a Gazebo that is stepped, with this project's perception, as a robot in lockstep.
/// Thread-safety: one thread.
class GazeboLockstep final : public LockstepRobot {
 public:
  /// Stands for half a second, so that each camera has delivered. Both outlive it.
  GazeboLockstep(SteppedGazebo& gazebo, PerceptionPipeline& perception);

  std::shared_ptr<const Belief> sense() override { return perception_.belief(gazebo_.time()); }
  CameraPicture picture() override;
  void apply(const Twist& command, double duration) override;
  double time() const override { return gazebo_.time(); }
  std::string fault() const override { return gazebo_.fault(); }
  std::string complaint() const override { return perception_.complaint(); }
  void watched_by(std::vector<MissionObserver*> observers) override;

  /// True poses of the robot since the call before, for who measures.
  std::deque<GazeboTruth::Stamped> take_truth();

 private:
  SteppedGazebo& gazebo_;
  PerceptionPipeline& perception_;
  std::vector<MissionObserver*> observers_;
  std::shared_ptr<const Image> left_;  // the newest
  std::deque<GazeboTruth::Stamped> truth_;
};

}  // namespace prospect
