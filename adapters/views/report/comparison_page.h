// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/views/report/divergence.h"

namespace prospect {

/// One of two runs that are compared.
struct ComparedRun {
  std::string name;
  std::string run;  ///< what its own page is made of: run_of_report(), or report_run()
};

/// Two missions under one slider, as one HTML page that works offline: both maps, what differs in
/// results and configuration, curves over each other, and where they part.
std::string comparison_page(const ComparedRun& first, const ComparedRun& second,
                            const Divergence& divergence);

/// What the page of a run, report.html, is made of. Throws InputError if it is no such page.
std::string run_of_report(const std::string& page, const std::string& path);

/// "part at 12.4 s (step 62), mode: explore, retreat; 0.5 m apart after 15.0 s".
std::string divergence_text(const Divergence& divergence);

}  // namespace prospect
