// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/configuration_reference.h"
#include "adapters/missions/config/registries.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/configuration_arguments.h"

namespace prospect {
namespace {

struct ConfigArguments {
  ConfigurationArguments configuration;
  bool reference = false;  ///< the page docs/reference/configuration.md instead
};

int print_reference(const ConfigurationArguments& given) {
  if (!given.empty()) {
    throw InputError("--reference: '" +
                     (given.file.empty() ? "--set " + given.set.front() : given.file) +
                     "' beside it; expected it alone, as it is of no configuration");
  }
  std::cout << configuration_reference();
  return kDone;
}

int print_configuration(const ConfigurationArguments& given, const Registries& registries) {
  std::cout << effective_yaml(read_told(given, registries, ConfigurationUse::kAny).entries);
  return kDone;
}

}  // namespace

Command config_command(CLI::App& program) {
  const auto given = std::make_shared<ConfigArguments>();
  CLI::App* command =
      program.add_subcommand("config", "The full effective configuration, with units and defaults");
  command->add_option("file", given->configuration.file, "Configuration file (YAML) [the defaults]")
      ->type_name("FILE");
  add_set(command, given->configuration);
  command->add_flag("--reference", given->reference,
                    "Every key with unit, range, default and meaning instead (Markdown)");
  return {command, [given](const Invocation& in) {
            return given->reference ? print_reference(given->configuration)
                                    : print_configuration(given->configuration, in.registries);
          }};
}

}  // namespace prospect
