// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace prospect {

/// The commit of git that this program was built from, in full; "" where there was no git. The
/// build writes the definitions (cmake/Commit.cmake).
std::string_view commit();
/// Whether files that git knows differed from that commit.
bool commit_changed();

}  // namespace prospect
