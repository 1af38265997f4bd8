// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/time_percentiles.h"

#include <nlohmann/json.hpp>

#include "engine/support/quantile.h"

namespace prospect {

TimePercentiles percentiles(const std::vector<double>& ms) {
  return {quantile(ms, 0.5), quantile(ms, 0.95), quantile(ms, 0.99), quantile(ms, 1.0)};
}

nlohmann::ordered_json times_json(const TimePercentiles& times) {
  return {{"p50", times.p50}, {"p95", times.p95}, {"p99", times.p99}, {"max", times.max}};
}

}  // namespace prospect
