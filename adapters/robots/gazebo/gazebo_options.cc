// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/gazebo/gazebo_options.h"

#include <cmath>
#include <vector>

#include "adapters/formats/files/input_error.h"

namespace prospect {

std::string gazebo_world_name(const GazeboOptions& options, const GazeboNode& node) {
  const std::string name = options.world.empty() ? node.world() : options.world;
  if (name.empty()) {
    fail("gazebo", "no world is published; expected a Gazebo that has loaded one");
  }
  return name;
}

std::vector<std::string> gazebo_depth_names(const GazeboOptions& options) {
  std::vector<std::string> names;
  for (int n = 0; n < options.depth_sensors && !options.depth.empty(); ++n) {
    names.push_back(n == 0 ? options.depth : options.depth + '_' + std::to_string(n));
  }
  return names;
}

void check(const GazeboOptions& options) {
  std::vector<std::string> lines;
  const auto positive = [&](const char* name, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      lines.push_back("gazebo." + std::string(name) + ": " + std::to_string(value) +
                      "; expected a number > 0");
    }
  };
  if (!(std::isfinite(options.image_noise) && options.image_noise >= 0.0)) {
    lines.push_back("gazebo.image_noise: " + std::to_string(options.image_noise) +
                    "; expected a number >= 0");
  }
  const auto named = [&](const char* name, const std::string& value) {
    if (value.empty()) lines.push_back("gazebo." + std::string(name) + ": empty; expected a name");
  };
  positive("wheel_radius", options.wheel_radius);
  positive("wheel_separation", options.wheel_separation);
  positive("dead_man", options.dead_man);
  positive("period", options.period);
  positive("silence", options.silence);
  positive("timeout", options.address.timeout);
  named("model", options.model);
  named("link", options.link);
  named("left_wheel", options.left_wheel);
  named("right_wheel", options.right_wheel);
  if (options.address.port < 1 || options.address.port > 65535) {
    lines.push_back("gazebo.port: " + std::to_string(options.address.port) +
                    "; expected 1 to 65535");
  }
  if (!lines.empty()) throw InputError(lines);
}

}  // namespace prospect
