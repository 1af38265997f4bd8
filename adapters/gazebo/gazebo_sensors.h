#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adapters/gazebo/gazebo_options.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// Cameras of a robot in Gazebo: its stereo pairs and depth images go into a SensorInbox as they
/// come, stamped with the simulation's time, which the inbox shifts into the runtime's clock. A
/// thread of its own receives them until the object ends; the inbox must live longer.
///
/// Thread-safety: any thread. Errors: the constructor throws as GazeboNode does, and InputError on
/// options out of range. Later nothing throws: see faults().
class GazeboSensors {
 public:
  GazeboSensors(const GazeboOptions& options, SensorInbox& inbox);
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
