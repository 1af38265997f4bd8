// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/gazebo/gazebo_truth.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "engine/maps/belief.h"
#include "engine/maps/grid.h"
#include "models/robot_description.h"
#include "runtime/truth.h"

namespace prospect {

/// What is true of a robot in Gazebo, in a world that is known, for evaluation: by the rules of the
/// simulator. Coverage is what rays of its depth cameras, cast from its true poses in the world's
/// voxels, have seen of what it can reach; a contact is a body that meets a voxel which is not
/// free. Thread-safety: one thread at a time. Errors: the constructor throws as DepthCamera's does.
class TrueRun final : public Truth {
 public:
  /// The poses that Gazebo has told since the call before, oldest first.
  using Poses = std::function<std::deque<GazeboTruth::Stamped>()>;
  /// reachable: cells of the world that count. The world outlives it.
  TrueRun(const World& world, const RobotDescription& robot, const DepthCameraOptions& looks,
          const Grid<std::uint8_t>& reachable, Poses poses);
  ~TrueRun() override;

  /// With all that Gazebo has told since the call before; the error is that of the belief, at its
  /// own stamp.
  TrueState at(const Belief& belief) override;
  /// As of the newest at().
  TrueState newest() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
