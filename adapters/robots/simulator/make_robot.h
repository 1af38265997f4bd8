// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "adapters/formats/worlds/world.h"
#include "adapters/robots/faults/injected_fault.h"
#include "adapters/robots/simulator/simulated_base_options.h"
#include "adapters/robots/simulator/simulator.h"
#include "adapters/robots/simulator/simulator_options.h"
#include "engine/maps/grid.h"
#include "models/robot_description.h"
#include "perception/pipeline/perception_options.h"
#include "runtime/clock.h"
#include "runtime/lockstep_robot.h"
#include "runtime/mission_observer.h"
#include "runtime/robot.h"
#include "runtime/sensor_inbox.h"
#include "runtime/truth.h"

namespace prospect {

/// What a simulated robot is made of.
struct SimulatedRobotConfiguration {
  std::shared_ptr<const World> world;
  RobotDescription robot;
  SimulatorOptions simulator;
  PerceptionOptions perception;
  Grid<std::uint8_t> reachable;  ///< Simulator::set_reachable()
  // In real time.
  SimulatedBaseOptions base{};
  SensorInboxOptions inbox{};
  std::vector<InjectedFault> faults{};  ///< but for those of planner and disk
  std::shared_ptr<const Clock> clock = std::make_shared<const SteadyClock>();
};

/// The simulator as a robot in real time. Throws as Simulator and SimulatedBase do.
Robot make_robot(const SimulatedRobotConfiguration& options);

/// The simulator as a robot in lockstep. Thread-safety: one thread. The constructor throws as
/// Simulator's does.
class SimulatedLockstep final : public LockstepRobot, public Truth, private FrameSink {
 public:
  explicit SimulatedLockstep(const SimulatedRobotConfiguration& options);
  void watched_by(std::vector<MissionObserver*> observers) override;

  std::shared_ptr<const Belief> sense() override { return simulator_.sense(); }
  CameraPicture picture() override { return simulator_.picture(); }
  void apply(const Twist& command, double duration) override {
    simulator_.apply(command, duration);
  }
  double time() const override { return simulator_.time(); }

  TrueState at(const Belief&) override { return newest(); }
  TrueState newest() const override;
  std::string complaint() const override { return simulator_.complaint(); }

 private:
  void observe(const SensorFrame& frame) override;

  Simulator simulator_;
  std::vector<MissionObserver*> observers_;
};

}  // namespace prospect
