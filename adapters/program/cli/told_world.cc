// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/told_world.h"

#include <iostream>

#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/progress.h"
#include "models/formatted.h"

namespace prospect {

std::string size_text(const World& world) {
  const GridFrame& frame = world.voxels.frame();
  return formatted("%.4g x %.4g m", frame.width * frame.resolution,
                   frame.height * frame.resolution);
}

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
  if (!world->assumed.empty()) {
    std::cerr << "prospect: " << world->name << ": taken for " << world->assumed << ", so "
              << size_text(*world) << "; prospect inspect " << name
              << " --picture FILE draws how it was read\n";
  }
  return world;
}

}  // namespace prospect
