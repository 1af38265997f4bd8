// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "adapters/formats/worlds/reachable_area.h"
#include "adapters/formats/worlds/world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/robots/simulator/simulator.h"
#include "engine/safety/guard.h"
#include "engine/safety/plan.h"

namespace prospect::python {

/// A simulated robot that somebody else drives, step by step, in lockstep. Planned and driven as in
/// run_mission() it goes the way that `prospect explore` goes, to the bit.
///
/// Thread-safety: one thread.
class Simulation {
 public:
  /// Throws InputError for a world that cannot be read, std::invalid_argument for options.
  Simulation(const std::string& world, const Configuration& configuration, std::uint64_t seed);

  /// Everything from the start, with another seed.
  void reset(std::uint64_t seed);

  /// The belief now, with the command in force. No time passes.
  std::shared_ptr<Belief> belief() const;
  /// Executes a body velocity for `duration` [s], without a guard.
  void apply(const Twist& command, double duration);
  /// Executes the committed stages of a plan (at least one), each after the guard has passed it; a
  /// command that the guard replaces ends it. Returns what the guard said last.
  GuardVerdict drive(const Plan& plan);

  const Simulator& truth() const { return *simulator_; }
  const Configuration& configuration() const { return configuration_; }
  const World& world() const { return *world_; }

 private:
  Configuration configuration_;
  std::shared_ptr<const World> world_;
  ReachableArea reachable_;
  Guard guard_;
  std::unique_ptr<Simulator> simulator_;
  Twist command_;  // in force
};

}  // namespace prospect::python
