#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "runtime/sensor_inbox.h"
#include "runtime/simulation_clock.h"

namespace prospect {

/// Who gets what the cameras see, stamped with the simulation's time [s]: an inbox, or what stands
/// before it. Both are called by one thread.
struct GazeboFrames {
  std::function<void(double stamp, ImagePair)> pair;
  std::function<void(double stamp, DepthImage)> depth;
};
/// Into that inbox, which outlives them.
GazeboFrames frames_into(SensorInbox& inbox);

/// Cameras of a robot in Gazebo: its stereo pairs and depth images are handed on as they come. They
/// set the clock to their time before. A thread of its own receives them until the object ends;
/// clock and receivers of frames must live longer.
///
/// Thread-safety: any thread. Errors: the constructor throws as GazeboReceiver does. Later nothing
/// throws: see faults().
class GazeboSensors {
 public:
  GazeboSensors(const GazeboOptions& options, SimulationClock& clock, GazeboFrames frames);
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
