// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "models/lower_case.h"

namespace prospect {

/// The ending of a file's name in lower case, with its dot: ".png" of "A.PNG"; "": it has none.
inline std::string lower_case_extension(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

}  // namespace prospect
