#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solvers/load_plugin.h"

namespace prospect {

/// Adds what the file of a --plugin offers to the registries; "" or a warning in one line. Throws
/// std::invalid_argument as load_plugin().
using LoadPlugin = std::function<std::string(const std::string& path, const PluginTargets&)>;

/// The program: does what its command line says and returns its exit code. Throws nothing: what is
/// wrong is a line on standard error. `program`: the words that start it anew, arguments after
/// them; it runs missions of studies and replays as processes of their own.
int run_command_line(int argc, char** argv, const LoadPlugin& load,
                     const std::vector<std::string>& program);

}  // namespace prospect
