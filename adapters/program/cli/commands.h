// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adapters/program/cli/command.h"

namespace prospect {

// Each adds a command to the program. The order is that of the help.
Command explore_command(CLI::App& program);
Command drive_command(CLI::App& program);
Command relay_command(CLI::App& program);
Command report_command(CLI::App& program);
Command export_command(CLI::App& program);
Command solve_command(CLI::App& program);
Command bench_command(CLI::App& program);
Command replay_command(CLI::App& program);
Command study_command(CLI::App& program);
Command reproduce_command(CLI::App& program);
Command inspect_command(CLI::App& program);
Command odometry_command(CLI::App& program);
Command map_command(CLI::App& program);
Command list_command(CLI::App& program);
Command config_command(CLI::App& program);

}  // namespace prospect
