#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adapters/gazebo/gazebo_options.h"
#include "runtime/sensor_inbox.h"
#include "runtime/simulation_clock.h"

namespace prospect {

/// Cameras of a robot in Gazebo: its stereo pairs and depth images go into a SensorInbox as they
/// come, stamped with the simulation's time, to which they set the clock before. A thread of its
/// own receives them until the object ends; clock and inbox must live longer.
///
/// Thread-safety: any thread. Errors: the constructor throws as GazeboReceiver does. Later nothing
/// throws: see faults().
class GazeboSensors {
 public:
  GazeboSensors(const GazeboOptions& options, SimulationClock& clock, SensorInbox& inbox);
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
