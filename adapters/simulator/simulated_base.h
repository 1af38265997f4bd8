#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adapters/simulator/faulty_motion.h"
#include "adapters/simulator/simulated_base_options.h"
#include "adapters/simulator/simulated_streams.h"
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
/// Faults (injected_fault.h). Those of sensors and their clock act in SimulatedStreams, those of
/// link, motors and wheels here, as does that of the command thread: report() makes it wait. Faults
/// of the planner and the disk are FaultyReplanner's and FaultyDisk's, what a scan holds is
/// faulty_scans()'.
///
/// Thread-safety: send(), stop() and report() from one thread, update() from another; truth() from
/// any. The simulator belongs to update() until all threads have ended. send(), stop() and report()
/// never wait for the simulator. sensors() and holds_command() are for any thread. Errors: the
/// constructor throws std::invalid_argument on options out of range.
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
  /// Whether a command is in force; else it has expired, or there was none.
  bool holds_command() const;
  /// What the sensors' frames go through.
  SensorInbox& sensors() { return streams_.inbox(); }
  double start() const { return epoch_; }  ///< [s] of the clock, where the time of faults begins

 private:
  struct Order {
    double acts = 0.0, ends = 0.0;  // [s] in the runtime's clock
    Twist command;
  };
  bool link_passes(double now) const;
  /// What acts at a time. Under the lock.
  Twist acting(double time) const;
  void advance(double now);
  bool holds(FaultSource source, FaultVerb verb, double now) const {
    return fault_at(options_.faults, source, verb, now - epoch_) != nullptr;
  }
  /// What the encoders measure. Under the lock.
  Twist measured(double now);
  /// The command thread's sleep, if a fault says so.
  void sleep_as_faults_say() const;

  Simulator& simulator_;
  const Clock& clock_;
  const SimulatedBaseOptions options_;
  const double epoch_;  // [s] in the runtime's clock
  BaseLimits limits_;
  FaultyMotion motion_;
  mutable std::mutex mutex_;  // orders_, truth_
  std::deque<Order> orders_;  // in order of time
  SimulatedTruth truth_;
  double last_report_ = 0.0, last_passed_ = 0.0;
  std::optional<Twist> stuck_velocity_;
  // Of update().
  double updated_ = 0.0;
  SimulatedStreams streams_;
};

}  // namespace prospect
