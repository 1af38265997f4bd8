// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// What the pages share, compiled into the program (see adapters/views/page/CMakeLists.txt).
namespace prospect::page_assets {

std::string_view style();          ///< page.css
std::string_view page_script();    ///< page.js
std::string_view dygraph_style();  ///< dygraphs, a plotting library (MIT)
std::string_view dygraph_script();

}  // namespace prospect::page_assets
