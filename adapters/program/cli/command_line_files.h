// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace prospect {

/// Writes what goes with the program into a folder such as PREFIX/share: completions for bash, zsh
/// and fish, and a manual page of the program and of each of its commands, all from the definitions
/// of its options. Returns an exit code; throws InputError if a file cannot be written.
int write_command_line_files(const CLI::App& app, const std::string& folder);

}  // namespace prospect
