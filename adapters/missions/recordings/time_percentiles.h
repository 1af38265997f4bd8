// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace prospect {

/// Median, 95 %, 99 % and largest of times [ms] (quantile.h); NaN where there were none.
struct TimePercentiles {
  double p50 = 0.0, p95 = 0.0, p99 = 0.0, max = 0.0;
};
TimePercentiles percentiles(const std::vector<double>& ms);
nlohmann::ordered_json times_json(const TimePercentiles& times);

}  // namespace prospect
