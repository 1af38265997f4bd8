// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "adapters/formats/files/child_process.h"
#include "adapters/program/cli/command_line.h"
#include "adapters/program/cli/printable_output.h"

int main(int argc, char** argv) {
  const prospect::PrintableOutput printable;
  return prospect::run_command_line(
      argc, argv,
      [](const std::string& path, const prospect::PluginTargets& targets) {
        return prospect::load_plugin(path, targets);
      },
      {prospect::own_program()});
}
