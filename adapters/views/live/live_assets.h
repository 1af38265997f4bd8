// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// What the live view adds to the report's page, compiled into the program (CMakeLists.txt).
namespace prospect::live_assets {

std::string_view controls();  ///< live.html
std::string_view style();     ///< live.css
std::string_view script();    ///< live.js

}  // namespace prospect::live_assets
