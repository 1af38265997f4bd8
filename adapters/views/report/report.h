// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// The run as one self-contained HTML page that works offline: the map growing under a time slider,
/// plots over time, the summary, and the effective configuration.
std::string render_report(const RunRecord& record);
/// What that page is made of, as JSON.
std::string report_run(const RunRecord& record);

// The same page for a run that goes on: it begins without steps, and is given them in parts.

/// What fills the page besides its own parts. HTML, styles and scripts are taken as they are.
struct ReportPage {
  std::string title;
  std::string_view kicker = "Mission report";  ///< above the title
  std::string_view connect = "'none'";         ///< connect-src of its Content-Security-Policy
  std::string_view style{};                    ///< after the page's own
  std::string_view controls{};                 ///< HTML between the head and the map
  std::string run;                             ///< report_start()
  std::string_view script{};  ///< after the page's own, whose `page` it may use: report.js
};
std::string render_page(const ReportPage& page);

/// What does not change from step to step, as JSON; of the summary what is known.
std::string report_start(const RunRecord& record);
/// Steps as JSON, for `page.append()`; resolution [m] of the ground cells. A part stands for itself
/// but for the map, of which it holds the changes since the part before.
std::string report_steps(const std::vector<std::shared_ptr<const StepRecord>>& steps,
                         double resolution);

}  // namespace prospect
