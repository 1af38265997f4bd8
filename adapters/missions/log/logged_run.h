// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/formats/bags/bag_file.h"
#include "adapters/missions/config/registries.h"
#include "adapters/missions/run/run_record.h"

namespace prospect {

/// A run as its log tells it.
struct LoggedRun {
  RunRecord record;
  /// What is to be said of it, a line each: it ends early, what was dropped, what the report has to
  /// do without.
  std::vector<std::string> notes;
};

/// Reads what MissionLog wrote, docs/reference/log.md, also a file that ends early, as of a program
/// that was killed: its summary is then made of the steps that are there. A mission that ended
/// before its first step is one without steps, whose summary says why. Throws InputError, one
/// line: no such file, no log of a mission, damaged; NotBuiltIn where the library for its
/// compression was absent at build time. `registries`: of the terms and back ends that its
/// configuration may name; one that cannot be read is noted, and robot and zones are then those of
/// the default configuration.
LoggedRun read_logged_run(const std::string& path, const Registries& registries = {});
/// Of a log that is open; `path` is for messages.
LoggedRun read_logged_run(const BagFile& bag, const std::string& path,
                          const Registries& registries);

}  // namespace prospect
