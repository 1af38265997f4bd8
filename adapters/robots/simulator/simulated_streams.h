#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "adapters/robots/simulator/sensor_tap.h"
#include "adapters/robots/simulator/simulated_base.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/maps/belief.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"
#include "runtime/sensor_inbox.h"

namespace prospect {

/// Who gets what the sensors of a simulated robot measure, stamped in the runtime's clock [s]: an
/// inbox, or what stands before it. All are called by one thread.
struct SimulatedFrames {
  /// What both cameras together make known, for each belief.
  std::function<void(double stamp, std::shared_ptr<const Belief> estimate)> pair;
  /// pose: where the robot took itself to be.
  std::function<void(double stamp, const DepthScan& in_B, const Pose& pose)> scan;
  std::function<void(double stamp, const DepthImage& depth)> depth;
};
/// Into FaultyFrames, which outlives them.
template <class Frames>
SimulatedFrames frames_into(Frames& frames) {
  return {[&frames](double stamp, std::shared_ptr<const Belief> estimate) {
            frames.pair(stamp, std::move(estimate));
          },
          [&frames](double stamp, const DepthScan& in_B, const Pose& pose) {
            frames.scan(stamp, in_B, std::make_shared<const Pose>(pose));
          },
          [&frames](double stamp, const DepthImage& depth) { frames.depth(stamp, depth); }};
}
/// As an inbox must take them.
SensorInboxOptions simulated_inbox(SensorInboxOptions options);

/// What a simulated robot knows in real time: its sensors' frames go out to SimulatedFrames and
/// come back through an inbox, which pairs, shifts and refuses them as it does those of a real
/// robot. What comes back decides what is known: pose, twist, covariance, localization and
/// landmarks are the cameras', the maps are made of the depth sensor's frames. Nothing carries the
/// pose on while no pair comes. A belief is as old as its pose; there is none before the first
/// pair.
///
/// Thread-safety: update() from one thread, which brings the world up to date with it.
class SimulatedStreams final : public BeliefSource {
 public:
  /// period: [s] from one belief to the next. listeners: who hears of what is measured, before
  /// anything becomes of it, in the runtime's clock. base, simulator, clock and inbox outlive it.
  SimulatedStreams(SimulatedBase& base, Simulator& simulator, const Clock& clock,
                   SensorInbox& inbox, SimulatedFrames frames, double period,
                   SensorTap listeners = {});
  ~SimulatedStreams() override;
  SimulatedStreams(const SimulatedStreams&) = delete;
  SimulatedStreams& operator=(const SimulatedStreams&) = delete;

  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;

 private:
  void take_frames();

  SimulatedBase& base_;
  Simulator& simulator_;
  const Clock& clock_;
  SensorInbox& inbox_;
  const SimulatedFrames frames_;
  const double period_;
  const SensorTap listeners_;
  double updated_;                    // [s]
  std::optional<Belief> of_cameras_;  // the newest that came through
};

}  // namespace prospect
