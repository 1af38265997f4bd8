#include "adapters/program/cli/world_arguments.h"

#include <cmath>
#include <iostream>

#include "adapters/formats/worlds/load_world.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/run/exploration_run.h"
#include "adapters/program/cli/progress.h"
#include "models/range_text.h"

namespace prospect {

void set_world(const WorldArguments& arguments, Configuration& configuration) {
  WorldOptions& world = configuration.world;
  if (!arguments.start.empty()) {
    const std::vector<double>& s = arguments.start;
    world.start = Pose{{s[0], s[1], 0.0}, s[2] * M_PI / 180.0};
    override_entry(
        configuration, "world.start",
        "[" + exact_text(s[0]) + ", " + exact_text(s[1]) + ", " + exact_text(s[2]) + "]");
  }
  if (arguments.floor) {
    world.floor = arguments.floor;
    // A text, which may be "lowest".
    override_entry(configuration, "world.floor", '"' + exact_text(*arguments.floor) + '"');
  }
  if (arguments.resolution > 0.0) {
    world.voxel_size = arguments.resolution;
    override_entry(configuration, "world.resolution", exact_text(arguments.resolution));
  }
  if (!arguments.unknown.empty()) {
    world.unknown_is_free = arguments.unknown == "free";
    override_entry(configuration, "world.unknown", arguments.unknown);
  }
  if (!arguments.up.empty()) {
    world.up = static_cast<UpAxis>(arguments.up[0] - 'x');
    override_entry(configuration, "world.up", arguments.up);
  }
  if (arguments.ground_margin) {
    world.ground_margin = *arguments.ground_margin;
    override_entry(configuration, "world.ground", exact_text(*arguments.ground_margin));
  }
}

std::shared_ptr<const World> loaded_world(const std::string& name,
                                          const Configuration& configuration, Progress& progress) {
  WorldOptions options = world_options_for(configuration);
  options.progress = [&](const std::string& what) { progress.show(what); };
  progress.show("reading " + name);
  auto world = std::make_shared<const World>(load_world(name, options));
  progress.finish();
  if (!world->left_out.empty()) {
    std::cerr << "prospect: " << world->name << ": read without: " << world->left_out.text()
              << '\n';
  }
  return world;
}

}  // namespace prospect
