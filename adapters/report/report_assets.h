#pragma once

#include <string_view>

/// The files that make up the page, compiled into the program (see adapters/CMakeLists.txt).
namespace prospect::report_assets {

std::string_view page();           ///< report.html, with {{places}} to fill
std::string_view style();          ///< report.css
std::string_view script();         ///< report.js
std::string_view page_script();    ///< page.js: what the scripts of all pages share
std::string_view dygraph_style();  ///< dygraphs, a plotting library (MIT)
std::string_view dygraph_script();

}  // namespace prospect::report_assets
