// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace prospect {

/// What a run was started with: with the program of this version and commit it can be made again.
/// It stands in the run folder and in the log from the first second.
struct RunStart {
  std::string world, solver;
  /// World as explore was given it: a name, or a file; and world_hash() of it, as hash_text(). Both
  /// "" where nobody knows the world.
  std::string world_source, world_hash;
  std::uint64_t seed = 0;
  bool real_time = false;       ///< not the simulator in lockstep, which alone is driven again
  std::string command_line;     ///< as a shell reads it
  std::string version;          ///< of the program
  std::string commit;           ///< in full; "" if it was built without git
  bool commit_changed = false;  ///< files that git knows differed from the commit
  std::string started;          ///< UTC, ISO 8601: "2026-11-26T17:02:11Z"
  std::string configuration;    ///< effective, as YAML
};

/// run.json: the names of RunStart as they are, without the configuration, which is a file of its
/// own; text that is not UTF-8 has replacement characters.
std::string start_json(const RunStart& start);

/// The time now, for RunStart::started.
std::string utc_now();

}  // namespace prospect
