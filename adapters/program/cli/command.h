// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "adapters/formats/files/exit_code.h"
#include "adapters/missions/config/registries.h"
#include "adapters/program/cli/command_line.h"

namespace CLI {
class App;
}

namespace prospect {

class SignalGuard;

/// How the program was called, but for the options of the command itself.
struct Invocation {
  const Registries& registries;
  std::string typed;                 ///< the command line, for the run folder
  std::vector<std::string> plugins;  ///< files, as given
  std::vector<std::string> program;  ///< words that start this program anew
  SignalGuard& signals;
  const LoadPlugin& load;
};

/// A command of the program: its options, described in its own file, and what runs it with what
/// they were given. Returns the exit code; throws as run_command_line() reports.
struct Command {
  CLI::App* options = nullptr;  ///< of the program's, which owns it
  std::function<int(const Invocation&)> run;
};

}  // namespace prospect
