// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

#include "runtime/clock.h"

namespace prospect {

/// The time of a simulation that runs beside this process, as the runtime's clock: what the robot
/// measures and what it is told are then in seconds of the world that it drives in, whose second
/// may take longer than one of the machine.
///
/// tick() tells the simulation's time, whenever a message bears it. In between time goes on at the
/// rate of the last half second, never faster than the machine's clock, and for 0.1 s at most: a
/// simulation that stands stops the clock. One that has said nothing for 5 s is lost, and time goes
/// on with the machine's clock from then on, so that ages grow and waits end. A world that waits
/// for a busy machine to render its images stands for more than a second at a time
/// (docs/results/gazebo.md). Time never goes back: where a tick is behind, the clock stands until
/// ticks have caught up. Before the first tick it begins at zero, with the machine's clock.
///
/// One tick that is ahead by more than a second and ten times what has passed since the one before
/// decides nothing: it counts once the next one agrees. So no message that is wrong sends time to
/// where no later one reaches.
///
/// After tick(s) that counts, now() >= s. Thread-safety: any thread. Nothing here throws.
class SimulationClock final : public Clock {
 public:
  /// Of the machine; it outlives this.
  explicit SimulationClock(const Clock& machine) noexcept;

  /// [s] of the simulation. An older one than the newest, and one that is not finite, is left out.
  void tick(double stamp) noexcept;

  double now() const noexcept override;
  bool wait_until(double time, const std::stop_token& stop) const noexcept override;

  static constexpr double kAhead = 0.1;  ///< [s] that time goes on after a tick
  static constexpr double kLost = 5.0;   ///< [s] without a tick after which it goes on again

 private:
  const Clock& machine_;
  mutable std::mutex mutex_;
  double stamp_ = 0.0, arrival_;                  // [s] of the newest tick, in either clock
  double rate_stamp_ = 0.0, rate_arrival_ = 0.0;  // since when the rate is counted
  double rate_ = 1.0;                             // [s/s]
  std::optional<double> leapt_;                   // [s] of a tick that does not count yet
  bool ticked_ = false;
  mutable double newest_ = 0.0;  // [s] that now() has said
};

}  // namespace prospect
