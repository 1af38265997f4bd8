// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "runtime/frame_sink.h"
#include "runtime/simulation_clock.h"

namespace prospect {

/// Cameras and IMU of a robot in Gazebo: its stereo pairs, depth images and samples are handed on
/// as they come. They set the clock to their time before. A thread of its own receives them until
/// the object ends; clock and frames (the inbox, or what stands before it) must live longer.
///
/// Thread-safety: any thread. Errors: the constructor throws as GazeboReceiver does. Later nothing
/// throws: see faults().
class GazeboSensors {
 public:
  GazeboSensors(const GazeboOptions& options, SimulationClock& clock, FrameSink& frames);
  ~GazeboSensors();
  GazeboSensors(const GazeboSensors&) = delete;
  GazeboSensors& operator=(const GazeboSensors&) = delete;

  /// The link to the master and those to the cameras stand.
  bool connected() const;
  /// What is wrong, a sentence each.
  std::vector<std::string> faults() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
