// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace prospect {

/// What a robot is told to do.
enum class TaskKind {
  kExplore,  ///< see all that can be seen, or what lies in a polygon
  kGoTo,     ///< go to a pose
  kReturn,   ///< go back to where it began
  kHold      ///< brake and stay
};

inline constexpr std::array kTaskKinds = {TaskKind::kExplore, TaskKind::kGoTo, TaskKind::kReturn,
                                          TaskKind::kHold};

/// "explore", "go to", "return", "hold".
constexpr std::string_view to_string(TaskKind kind) {
  switch (kind) {
    case TaskKind::kExplore:
      return "explore";
    case TaskKind::kGoTo:
      return "go to";
    case TaskKind::kReturn:
      return "return";
    case TaskKind::kHold:
      return "hold";
  }
  return "?";
}

/// Whether the task leads to a place.
constexpr bool has_goal(TaskKind kind) {
  return kind == TaskKind::kGoTo || kind == TaskKind::kReturn;
}

}  // namespace prospect
