// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The files that make up the page, compiled into the program (see
/// adapters/formats/datasets/CMakeLists.txt).
namespace prospect::map_assets {

std::string_view map_html();  ///< with {{places}} to fill
std::string_view map_css();   ///< on top of page.css
std::string_view map_js();
std::string_view three_script();  ///< three.js, 3-D in a browser (MIT)
std::string_view orbit_script();  ///< its camera that turns about a point

}  // namespace prospect::map_assets
