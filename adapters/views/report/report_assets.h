// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The files that make up the page, compiled into the program (see
/// adapters/views/report/CMakeLists.txt).
namespace prospect::report_assets {

std::string_view page();    ///< report.html, with {{places}} to fill
std::string_view script();  ///< report.js

std::string_view comparison_page();          ///< comparison.html, likewise
std::string_view comparison_style();         ///< comparison.css
std::string_view comparison_script();        ///< comparison.js
std::string_view comparison_frame_style();   ///< comparison_frame.css: of each of its two reports
std::string_view comparison_frame_script();  ///< comparison_frame.js

}  // namespace prospect::report_assets
