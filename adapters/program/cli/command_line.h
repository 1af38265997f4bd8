// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "adapters/missions/config/registries.h"
#include "adapters/robots/user/return_deadline.h"
#include "solvers/load_plugin.h"

namespace prospect {

class SignalGuard;

/// Adds what the file of a --plugin offers to the registries; "" or a warning in one line. Throws
/// std::invalid_argument as load_plugin().
using LoadPlugin = std::function<std::string(const std::string& path, const PluginTargets&)>;

/// Adds what the files of plug-ins offer, with a line on standard error for each warning. Throws as
/// load_plugin() and load_robot(). A file whose entry does not come back within `patience` [s] ends
/// the process, with a line (ReturnDeadline).
void load_plugins(const std::vector<std::string>& plugins, const LoadPlugin& load,
                  Registries& registries, double patience = ReturnDeadline::kEntryPatience);

/// Runs a program under a SignalGuard and returns its exit code. Throws nothing: what is wrong,
/// also with its output, is a line on standard error.
int reported(const std::function<int(SignalGuard&)>& program);

/// The command line as typed, but for the token, which is nobody's to read in a run folder.
std::string typed_line(int argc, const char* const* argv);

/// The program: does what its command line says, reported(). `program`: the words that start it
/// anew, arguments after them; it runs missions of studies and replays as processes of their own.
int run_command_line(int argc, char** argv, const LoadPlugin& load,
                     const std::vector<std::string>& program);

}  // namespace prospect
