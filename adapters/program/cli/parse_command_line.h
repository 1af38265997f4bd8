// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace prospect {

/// Parses the arguments of the program, the first of which is its own name. Throws InputError in
/// one line for bad ones: an unknown command or option with the nearest known one, a value that is
/// missing or out of range, an argument too many. CLI::Success (--help) passes through.
void parse_command_line(CLI::App& app, int argc, const char* const* argv);

}  // namespace prospect
