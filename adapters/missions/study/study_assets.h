// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The page of a study, compiled into the program (see adapters/missions/study/CMakeLists.txt).
namespace prospect::study_assets {

std::string_view study_html();
std::string_view study_css();

}  // namespace prospect::study_assets
