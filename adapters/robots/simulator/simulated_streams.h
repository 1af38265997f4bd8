// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/maps/belief.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/frame_sink.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// As an inbox must take them.
SensorInboxOptions simulated_inbox(SensorInboxOptions options);

/// What a simulated robot knows in real time: its sensors' frames go out to a FrameSink and
/// come back through an inbox, which pairs, shifts and refuses them as it does those of a real
/// robot. What comes back decides what is known: pose, twist, covariance, localization and
/// landmarks are the cameras', the maps are made of the depth sensor's frames. Nothing carries the
/// pose on while no pair comes. A belief is as old as its pose; there is none before the first
/// pair.
///
/// Thread-safety: update() from one thread, which brings the world up to date with it.
class SimulatedStreams final : public BeliefSource, private FrameSink {
 public:
  /// frames: the inbox, or what stands before it. period: [s] from one belief to the next. All
  /// outlive it. Observers are told of what is measured, before anything becomes of it.
  SimulatedStreams(SimulatedBase& base, Simulator& simulator, const Clock& clock,
                   SensorInbox& inbox, FrameSink& frames, double period);
  ~SimulatedStreams() override;
  SimulatedStreams(const SimulatedStreams&) = delete;
  SimulatedStreams& operator=(const SimulatedStreams&) = delete;

  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;
  std::shared_ptr<const Belief> known() override { return simulator_.sense(); }
  std::string complaint() const override { return simulator_.complaint(); }
  CameraPicture picture() override { return simulator_.picture(); }

 private:
  void observe(const SensorFrame& measured) override;  // by the simulator, in its time
  void take_frames();

  SimulatedBase& base_;
  Simulator& simulator_;
  const Clock& clock_;
  SensorInbox& inbox_;
  FrameSink& frames_;
  const double period_;
  double updated_;                    // [s]
  std::optional<Belief> of_cameras_;  // the newest that came through
};

}  // namespace prospect
