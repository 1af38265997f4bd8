#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adapters/simulator/simulated_base_options.h"
#include "adapters/simulator/simulator.h"
#include "engine/maps/belief.h"
#include "models/motion_model.h"
#include "runtime/base.h"
#include "runtime/belief_source.h"
#include "runtime/clock.h"

namespace prospect {

/// What is true of a simulated robot, for evaluation.
struct SimulatedTruth {
  Pose pose;
  double coverage = 0.0;
  double seen_area = 0.0;           ///< [m^2]
  double localization_error = 0.0;  ///< [m]
  double path_length = 0.0;         ///< [m]
  int collisions = 0;
  int losses = 0;
  CameraPicture picture;  ///< newest left image; empty without cameras
};
SimulatedTruth truth_of(const Simulator& simulator);

/// The simulator as a robot in real time: motors that take commands with an expiry, and what
/// perceives. The world goes on with the clock, whether commands come or not. Its time 0 is the
/// clock's when this was made; stamps of beliefs are in the runtime's clock.
///
/// Motion. A command acts `delay` after it was sent, until the next one acts, it expires, or
/// `dead_man` has passed since it came: then the robot stands. The world is brought up to date when
/// a belief is asked for, along the commands that acted since, each for its time; so what a belief
/// costs to make does not change where the robot drives.
///
/// Thread-safety: send(), stop() and report() from one thread, update() from another; truth() from
/// any. The simulator belongs to update() until all threads have ended. send(), stop() and report()
/// never wait for the simulator. Errors: the constructor throws std::invalid_argument on options
/// out of range.
class SimulatedBase final : public Base, public BeliefSource {
 public:
  /// simulator and clock outlive it.
  SimulatedBase(Simulator& simulator, const Clock& clock, const MotionModel& model,
                const SimulatedBaseOptions& options);

  std::string name() const noexcept override { return "simulator"; }
  std::optional<double> dead_man() const noexcept override { return options_.dead_man; }
  BaseLimits limits() const noexcept override { return limits_; }
  void send(const Twist& command, double expires) noexcept override;
  void stop() noexcept override;
  BaseReport report() noexcept override;

  std::shared_ptr<const Belief> update(const std::stop_token& stop) override;

  SimulatedTruth truth() const;
  /// The runtime's time at which the simulator's was 0 [s].
  double epoch() const { return epoch_; }

 private:
  struct Order {
    double acts = 0.0, ends = 0.0;  // [s] in the runtime's clock
    Twist command;
  };
  bool link_passes(double now) const;
  /// What acts at a time. Under the lock.
  Twist acting(double time) const;
  void advance(double now);
  std::shared_ptr<const Belief> as_faults_say(Belief belief, double now);

  Simulator& simulator_;
  const Clock& clock_;
  const SimulatedBaseOptions options_;
  const double epoch_;  // [s] in the runtime's clock
  BaseLimits limits_;
  mutable std::mutex mutex_;  // orders_, truth_
  std::deque<Order> orders_;  // in order of time
  SimulatedTruth truth_;
  double last_report_ = 0.0;
  // Of update().
  double updated_ = 0.0;
  std::deque<Belief> before_;                    // the newest ones, for what is delayed
  std::optional<Belief> of_cameras_, of_depth_;  // the newest that came through
};

}  // namespace prospect
