// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "runtime/drive_mode.h"

namespace prospect {

/// The contract of a signal that safety rests on: who says it, how often, how old it may be, with
/// which frame and values, and what becomes of the robot where it is otherwise. One bad sample
/// decides nothing, several do (sample_judge.h).
struct Link {
  std::string signal;  ///< "odometry"
  std::string topic;   ///< empty: none is set up
  /// Who publishes it, this program with them if it does; most 0: any number.
  int least = 1, most = 1;
  std::optional<double> heartbeat{};  ///< [s] longest silence; none: it may be silent
  std::optional<double> age{};        ///< [s] most, from its stamp
  std::string frame{}, values{};      ///< what a message must say, in words; empty: anything
  // Why the robot stops then, or does not set out; none: it drives on.
  std::optional<DriveCause> absent{};   ///< fewer than `least` are there, or they are silent
  std::optional<DriveCause> doubled{};  ///< more than `most` are there
  std::optional<DriveCause> wrong{};    ///< messages are none, or not with that frame and values
};

/// As text for people, Markdown.
std::string link_table(std::span<const Link> links);

}  // namespace prospect
