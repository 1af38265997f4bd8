// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/told_world.h"

#include <iostream>

#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/progress.h"

namespace prospect {

std::shared_ptr<const World> told_world(const std::string& name, const Configuration& configuration,
                                        ConfigurationUse use, Progress& progress) {
  progress.show("reading " + name);
  const auto world = mission_world(name, configuration, use,
                                   [&](const std::string& what) { progress.show(what); });
  progress.finish();
  if (!world->left_out.empty()) {
    std::cerr << "prospect: " << world->name << ": read without: " << world->left_out.text()
              << '\n';
  }
  return world;
}

}  // namespace prospect
