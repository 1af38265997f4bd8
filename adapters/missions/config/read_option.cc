// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/read_option.h"

#include <limits>

namespace prospect {

OptionValue read_option(YamlMap map, const OptionInfo& option) {
  if (const int* fallback = std::get_if<int>(&option.fallback)) {
    return static_cast<int>(map.integer(option.name, *fallback, std::numeric_limits<int>::lowest(),
                                        std::numeric_limits<int>::max(), "", option.description));
  }
  if (const double* fallback = std::get_if<double>(&option.fallback)) {
    return map.number(option.name, *fallback, std::numeric_limits<double>::lowest(),
                      std::numeric_limits<double>::max(), "", option.description);
  }
  return map.text(option.name, std::get<std::string>(option.fallback), option.description);
}

}  // namespace prospect
