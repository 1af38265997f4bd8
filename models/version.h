// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace prospect {

/// The version of Prospect. The one place it is written: CMakeLists.txt reads it here. Not
/// `inline`: every library keeps the version it was compiled with, whatever it is loaded into.
constexpr char kVersion[] = "0.2.0";

}  // namespace prospect
