// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace prospect {

/// How well the robot knows where it is. Lost: its pose is dead reckoning, and its map does not
/// grow.
enum class Localization { kOk, kDegraded, kLost };

/// "ok", "degraded", "lost".
constexpr std::string_view to_string(Localization localization) {
  switch (localization) {
    case Localization::kOk:
      return "ok";
    case Localization::kDegraded:
      return "degraded";
    case Localization::kLost:
      return "lost";
  }
  return "?";
}

}  // namespace prospect
