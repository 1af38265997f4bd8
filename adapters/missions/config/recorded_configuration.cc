// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/recorded_configuration.h"

#include <vector>

#include "adapters/missions/config/key_readers.h"

namespace prospect {

std::string recorded_yaml(const Configuration& configuration, ConfigurationUse use) {
  const KeyReader reader = key_reader(configuration, use);
  std::vector<ConfigEntry> read = configuration.entries;
  std::erase_if(
      read, [&](const ConfigEntry& entry) { return !unread_because(entry.path, reader).empty(); });
  return effective_yaml(read);
}

}  // namespace prospect
