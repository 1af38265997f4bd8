// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "adapters/robots/simulator/simulated_base_options.h"
#include "adapters/robots/simulator/simulator.h"
#include "models/motion_model.h"
#include "runtime/base.h"
#include "runtime/clock.h"
#include "runtime/truth.h"

namespace prospect {

TrueState truth_of(const Simulator& simulator);

/// The simulator's motors in real time: a base that takes commands with an expiry. The world goes
/// on with the clock, whether commands come or not. Its time 0 is the clock's when this was made.
///
/// Motion. A command acts `delay` after it was sent, until the next one acts, it expires, or
/// `dead_man` has passed since it came: then the robot stands. The world is brought up to date by
/// advance(), along the commands that acted since, each for its time; so what a belief costs to
/// make does not change where the robot drives.
///
/// Thread-safety: send(), stop() and report() from one thread, advance() from another, to which the
/// simulator belongs until all threads have ended; the others from any. Nobody waits for the
/// simulator but advance(). Errors: the constructor throws std::invalid_argument on options out of
/// range.
class SimulatedBase final : public Base, public Truth {
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

  /// Brings the world up to the time `now` [s] of the clock.
  void advance(double now);

  TrueState at(const Belief&) override { return newest(); }
  TrueState newest() const override;
  /// Whether a command is in force; else it has expired, or there was none.
  bool holds_command() const;
  double start() const { return epoch_; }  ///< [s] of the clock, the simulator's time 0

 private:
  struct Order {
    double acts = 0.0, ends = 0.0;  // [s] in the runtime's clock
    Twist command;
  };
  /// What acts at a time. Under the lock.
  Twist acting(double time) const;

  Simulator& simulator_;
  const Clock& clock_;
  const SimulatedBaseOptions options_;
  const double epoch_;  // [s] in the runtime's clock
  BaseLimits limits_;
  mutable std::mutex mutex_;  // orders_, truth_
  std::deque<Order> orders_;  // in order of time
  TrueState truth_;
};

}  // namespace prospect
