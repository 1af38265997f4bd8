// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/recorded_configuration.h"

#include <vector>

#include "adapters/missions/config/key_readers.h"

namespace prospect {

std::vector<YamlSetting> settings_before_their_keys() {
  std::vector<YamlSetting> settings = {
      "perception.loops=false",           "perception.movers.enabled=false",
      "perception.mapping.slopes=false",  "simulator.camera.realism=0",
      "simulator.odometry.scale_error=0", "simulator.odometry.direction_error=0",
      "simulator.odometry.turn_error=0"};
  for (YamlSetting& setting : settings) {
    setting.where = "recorded before the key";
    setting.unless_told = true;
  }
  return settings;
}

std::string recorded_yaml(const Configuration& configuration, ConfigurationUse use) {
  const KeyReader reader = key_reader(configuration, use);
  std::vector<ConfigEntry> read = configuration.entries;
  std::erase_if(
      read, [&](const ConfigEntry& entry) { return !unread_because(entry.path, reader).empty(); });
  return effective_yaml(read);
}

}  // namespace prospect
