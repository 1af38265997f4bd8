// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The files that make up the page, compiled into the program (see
/// adapters/views/report/CMakeLists.txt).
namespace prospect::report_assets {

std::string_view page();    ///< report.html, with {{places}} to fill
std::string_view script();  ///< report.js

}  // namespace prospect::report_assets
