#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/configuration_reference.h"
#include "adapters/missions/config/registries.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"

namespace prospect {
namespace {

struct ConfigArguments {
  std::string file;                   ///< empty: the defaults
  std::vector<std::string> settings;  ///< above the file
  bool reference = false;             ///< the page docs/reference/configuration.md instead
};

int print_reference(const std::string& file, const std::vector<std::string>& settings) {
  if (!file.empty() || !settings.empty()) {
    throw InputError("--reference: '" + (file.empty() ? "--set " + settings.front() : file) +
                     "' beside it; expected it alone, as it is of no configuration");
  }
  std::cout << configuration_reference();
  return kDone;
}

int print_configuration(const std::string& file, const std::vector<std::string>& settings,
                        const Registries& registries) {
  std::cout << effective_yaml(read_configuration(file, registries, settings).entries);
  return kDone;
}

}  // namespace

Command config_command(CLI::App& program) {
  const auto given = std::make_shared<ConfigArguments>();
  CLI::App* command =
      program.add_subcommand("config", "The full effective configuration, with units and defaults");
  command->add_option("file", given->file, "Configuration file (YAML) [the defaults]")
      ->type_name("FILE");
  add_set(command, given->settings);
  command->add_flag("--reference", given->reference,
                    "Every key with unit, range, default and meaning instead (Markdown)");
  return {command, [given](const Invocation& in) {
            return given->reference
                       ? print_reference(given->file, given->settings)
                       : print_configuration(given->file, given->settings, in.registries);
          }};
}

}  // namespace prospect
