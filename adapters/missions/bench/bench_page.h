// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace prospect {

/// One self-contained HTML page that works offline, from what bench_json() gives: tables,
/// performance profiles, cost against time and evaluations.
std::string bench_page(const nlohmann::ordered_json& bench);

}  // namespace prospect
