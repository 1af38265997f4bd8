// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/python/simulation.h"

#include <algorithm>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/run/exploration_run.h"
#include "engine/planner/planner_guard.h"

namespace prospect::python {

Simulation::Simulation(const std::string& world, const Configuration& configuration,
                       std::uint64_t seed)
    : configuration_(configuration),
      world_(std::make_shared<const World>(load_world(world, world_options_for(configuration)))),
      reachable_(told_area(reachable_area(*world_, configuration), configuration)),
      guard_(
          guard_for(configuration.robot, configuration.planner, guard_limits_for(configuration))) {
  check_start(*world_, configuration);
  reset(seed);
}

void Simulation::reset(std::uint64_t seed) {
  simulator_ = std::make_unique<Simulator>(world_, simulator_options_for(configuration_, seed),
                                           configuration_.perception);
  simulator_->set_reachable(reachable_.cells);
  command_ = simulator_->sense()->twist;
}

std::shared_ptr<Belief> Simulation::belief() const {
  auto belief = std::make_shared<Belief>(*simulator_->sense());
  belief->command = command_;
  return belief;
}

void Simulation::apply(const Twist& command, double duration) {
  simulator_->apply(command, duration);
  command_ = command;
}

GuardVerdict Simulation::drive(const Plan& plan) {
  const int stages =
      std::max(1, std::min<int>(plan.committed, static_cast<int>(plan.commands.size())));
  GuardVerdict verdict;
  for (int stage = 0; stage < stages; ++stage) {
    verdict = guard_.check(plan, stage, command_, *simulator_->sense(), simulator_->time());
    apply(verdict.command, verdict.duration);
    if (!verdict.passed()) break;
  }
  return verdict;
}

}  // namespace prospect::python
