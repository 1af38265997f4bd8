// SPDX-License-Identifier: Apache-2.0
#include "engine/task/zones.h"

#include <cmath>

namespace prospect {

std::vector<std::string> faults(const Zones& zones) {
  std::vector<std::string> list;
  const auto check = [&](const std::string& name, const Polygon& polygon) {
    if (const std::string fault = polygon_fault(polygon); !fault.empty()) {
      list.push_back(name + ": " + fault);
    }
  };
  if (zones.bound) check("bound", *zones.bound);
  for (std::size_t i = 0; i < zones.keep_out.size(); ++i) {
    check("keep_out[" + std::to_string(i) + "]", zones.keep_out[i]);
  }
  for (std::size_t i = 0; i < zones.slow.size(); ++i) {
    const std::string name = "slow[" + std::to_string(i) + "]";
    check(name, zones.slow[i].area);
    const double speed = zones.slow[i].max_speed;
    if (!(speed > 0.0) || !std::isfinite(speed)) {
      list.push_back(name + ": max_speed is " + std::to_string(speed) +
                     " m/s; expected a finite speed > 0");
    }
  }
  return list;
}

}  // namespace prospect
