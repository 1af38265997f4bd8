#include <string>

#include "adapters/cli/command_line.h"
#include "adapters/files/child_process.h"

int main(int argc, char** argv) {
  return prospect::run_command_line(
      argc, argv,
      [](const std::string& path, const prospect::PluginTargets& targets) {
        return prospect::load_plugin(path, targets);
      },
      {prospect::own_program()});
}
