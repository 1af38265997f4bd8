// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace prospect {

/// A recording as a benchmark is told it: "PATH", or "PATH@12" from frame 12 on.
struct Clip {
  std::string path;
  std::string name;  ///< the last part of the path
  int first = 0;     ///< frame
};

inline Clip clip_of(const std::string& told) {
  const std::size_t at = told.rfind('@');
  Clip clip{told.substr(0, at), "", 0};
  clip.name = std::filesystem::path(clip.path).filename().string();
  if (at != std::string::npos) clip.first = std::max(0, std::atoi(told.c_str() + at + 1));
  return clip;
}

}  // namespace prospect
