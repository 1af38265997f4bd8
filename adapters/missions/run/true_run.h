#pragma once

#include <memory>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/robots/gazebo/gazebo_truth.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "engine/maps/belief.h"

namespace prospect {

/// What is true of a robot in Gazebo, in a world that is known, for evaluation: by the rules of the
/// simulator. Coverage is what rays of its depth camera, cast from its true poses in the world's
/// voxels, have seen of what it can reach; a contact is a body that meets a voxel which is not
/// free. losses are not counted. Thread-safety: one thread at a time. Errors: the constructor
/// throws as reachable_area() and DepthCamera do.
class TrueRun {
 public:
  /// The world outlives it.
  TrueRun(const World& world, const Configuration& configuration, GazeboTruth truth);
  ~TrueRun();

  /// With all that Gazebo has told since the call before; the error is that of the belief, at its
  /// own stamp.
  SimulatedTruth at(const Belief& belief);
  /// As of the newest at().
  SimulatedTruth truth() const;
  const ReachableArea& reachable() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
