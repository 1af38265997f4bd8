#pragma once

#include <string>

#include "adapters/run/run_record.h"

namespace prospect {

/// The run as one self-contained HTML page that works offline: the map growing under a time slider,
/// plots over time, the summary, and the effective configuration.
std::string render_report(const RunRecord& record);

}  // namespace prospect
