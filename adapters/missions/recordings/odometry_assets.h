// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The files that make up the page, compiled into the program (see adapters/CMakeLists.txt).
namespace prospect::odometry_assets {

std::string_view odometry_html();  ///< with {{places}} to fill
std::string_view odometry_css();   ///< on top of report.css
std::string_view odometry_js();

}  // namespace prospect::odometry_assets
