// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// Fills what follows from the steps: coverage, area, collisions, duration, path length, time and
/// path to 90 / 95 / 99 % coverage (linear between the steps around it; NaN if never reached),
/// localization error (root mean square over steps, final, and final as percent of the path; NaN
/// without steps, without a path), planning time percentiles (nearest rank, quantile.h), fallbacks,
/// guard stops, steps. All else keeps its default.
Summary summarize(const std::vector<StepRecord>& steps);

/// summary.json: the names of Summary as they are, the planning time percentiles under plan_ms;
/// numbers that are not finite are null; text that is not UTF-8 has replacement characters.
std::string summary_json(const Summary& summary);

/// The summary that summary_json() has written; what is not there keeps its default. None: the text
/// is none.
std::optional<Summary> summary_from_json(const std::string& text);

}  // namespace prospect
