// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "adapters/robots/gazebo/gazebo_options.h"
#include "runtime/base.h"
#include "runtime/simulation_clock.h"

namespace prospect {

/// A differential drive in Gazebo as a Base. Commands go through a VelocityRelay, which is its
/// dead-man: without it the plug-in holds its last command for ever. Velocity and wheel motion are
/// those of the wheels' encoders (wheel_encoder.h), stamped with the simulation's time; where
/// Gazebo knows the robot to be is not used.
///
/// It starts a process and a thread: make it before other threads. Errors: the constructor throws
/// as VelocityRelay does. Later, links that break and messages that cannot be read are faults in
/// report(); wheels that say nothing show in its stamp.
class GazeboBase final : public Base {
 public:
  /// The clock is that of commands' expiry, and must outlive this; it is set by what comes. The
  /// relay has one of its own, set by the same.
  GazeboBase(const GazeboOptions& options, SimulationClock& clock);
  ~GazeboBase() override;

  std::string name() const noexcept override;
  std::optional<double> dead_man() const noexcept override;
  void send(const Twist& command, double expires) noexcept override;
  void stop() noexcept override;
  BaseReport report() noexcept override;

  /// The name of the world.
  const std::string& world() const;
  /// Of the relay.
  int relay_process() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
