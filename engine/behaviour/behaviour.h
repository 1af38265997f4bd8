// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/behaviour/facts.h"
#include "engine/behaviour/mode.h"

namespace prospect {

class Knobs;

inline constexpr double kMoved = 0.1;  ///< [m] from where it began, a robot has moved

/// Times that the table asks for [s].
struct BehaviourOptions {
  double retreat_time = 6.0;    ///< longest single retreat
  double turn_time = 7.0;       ///< a robot that is lost after one turns on the spot for as long: a
                                ///< full turn shows all that is to be seen from there
  double retreat_pause = 20.0;  ///< from the end of one to the next
  double lost_patience = 3.0;   ///< a robot that got lost anew in that pause explores on as long
  double turn_away_time = 3.0;  ///< a robot that does not follow its commands turns as long
  double look_around = 8.0;     ///< nothing must have been reachable as long before "done"
};

/// The knobs (models/knobs.h); turn_away_time is the planner's.
void describe(Knobs& knobs, BehaviourOptions& options);

/// What the robot is doing, why, and what must be remembered of retreats to decide what it does
/// next. A value.
struct Behaviour {
  Mode mode;
  double retreat_ended = -std::numeric_limits<double>::infinity();  ///< [s] the last one
  bool retreat_failed = false;        ///< it ended without enough features
  bool enough_since_retreat = false;  ///< enough features were tracked, at or after its end
};

/// A row of the table of modes: from (none: any) · condition on facts · to · cause (none: as it
/// was). In order of precedence: the first row that holds is taken.
struct ModeRow {
  struct Case {
    const Behaviour& before;
    const Facts& facts;
    const BehaviourOptions& options;
  };
  std::optional<ModeKind> from;
  std::string_view condition;
  bool (*holds)(const Case&);
  ModeKind to;
  std::optional<Cause> cause;
};

/// Total: its last rows hold always.
std::span<const ModeRow> mode_table();

/// The row that decides. Pure.
const ModeRow& deciding_row(const Behaviour& before, const Facts& facts,
                            const BehaviourOptions& options);

/// What the robot does next: pure, so it may be asked before the frontiers are up to date (no
/// facts.frontiers) whether it will pursue its target, and again with all facts.
Behaviour decide(const Behaviour& before, const Facts& facts, const BehaviourOptions& options);

/// One sentence: what the robot does and why, with the numbers of these facts, e.g.
/// "Turns back: 8 features in view, localization degraded; 41 were tracked 1.2 m from here."
std::string describe(const Mode& mode, const Facts& facts);

/// The tables of modes, policies and safety levels as text for people, Markdown.
std::string behaviour_tables();

}  // namespace prospect
