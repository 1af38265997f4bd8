// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// The page of a replay, compiled into the program (see adapters/missions/replay/CMakeLists.txt).
namespace prospect::replay_assets {

std::string_view replay_html();
std::string_view replay_css();
std::string_view replay_js();

}  // namespace prospect::replay_assets
