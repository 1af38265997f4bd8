// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "adapters/formats/files/strict_yaml.h"
#include "adapters/missions/config/configuration.h"

namespace prospect {

/// What the command line says of a configuration. One rule says which value of a key counts: the
/// last one of --set; else that of an option which is a spelling of the key (add_key()); else the
/// file's; else that of the environment (YamlSetting::unless_told); else the default.
struct ConfigurationArguments {
  std::string file;                  ///< of --config; "": none
  std::vector<YamlSetting> spelled;  ///< by options with a name of their own
  std::vector<std::string> set;      ///< by --set

  bool empty() const { return file.empty() && spelled.empty() && set.empty(); }
  /// For read_configuration(), where the later stands above the earlier.
  std::vector<YamlSetting> settings() const;
};

/// Tells notices of a configuration on stderr, each once.
void tell_notices(std::vector<std::string> notices);
/// read_configuration() of the arguments, above the settings `below`; its notices are told.
Configuration read_told(const ConfigurationArguments& arguments, const Registries& registries,
                        ConfigurationUse use, std::vector<YamlSetting> below = {});
/// read_perception() likewise.
PerceptionOptions read_told_perception(const ConfigurationArguments& arguments,
                                       const PerceptionOptions& defaults, ConfigurationUse use);

/// --set KEY=VALUE.
void add_set(CLI::App* command, ConfigurationArguments& arguments);
/// --config FILE and --set. of: what the help says of the file besides.
void add_configuration(CLI::App* command, ConfigurationArguments& arguments,
                       const std::string& of = "");

/// An option that is a spelling of `--set KEY=VALUE`. Its help is the key's description, with unit
/// and range; what it takes is checked as the key is.
struct KeyOption {
  std::string name;             ///< "--time-limit"
  std::string key;              ///< "mission.time_limit"
  std::string type = "NUMBER";  ///< of a value that is no choice: "FILE"
  int count = 1;                ///< of numbers in a list
};
CLI::Option* add_key(CLI::App* command, ConfigurationArguments& arguments, const KeyOption& option);

/// How a world is read.
void add_world_keys(CLI::App* command, ConfigurationArguments& arguments);

}  // namespace prospect
