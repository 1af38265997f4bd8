// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/missions/recordings/time_percentiles.h"

namespace prospect {

/// What places that look the same made of a run's poses. None of it is in OdometryRun, whose poses
/// stay those of the odometry alone.
struct OdometryLoopsResult {
  int views = 0;          ///< keyframes that could be known again
  int found = 0;          ///< loops
  int used = 0;           ///< of them; the others speak against the rest of the graph
  double farthest = 0.0;  ///< [m] that they have moved a pose by, at most
  /// One that is used: which two frames show the same, and where they were taken by all loops [m].
  struct Loop {
    double older_stamp = 0.0, newer_stamp = 0.0;
    Eigen::Vector3d older = Eigen::Vector3d::Zero(), newer = Eigen::Vector3d::Zero();
  };
  std::vector<Loop> loops;
  Trajectory final;           ///< of frames that are not lost, by all loops of the recording
  Trajectory online;          ///< each pose by the loops that were found up to its frame
  TimePercentiles processor;  ///< [ms] a view
};

/// The poses of a recording, straightened as its views come again (view_loops.h). Made with Ceres
/// only; throws std::invalid_argument without it.
class OdometryLoops {
 public:
  explicit OdometryLoops(const StereoCamera& camera);
  ~OdometryLoops();
  OdometryLoops(OdometryLoops&&) noexcept;

  void add(const OdometryStep& step);
  /// Of all frames so far.
  OdometryLoopsResult result();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
