// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/configuration_arguments.h"

#include <algorithm>
#include <cctype>
#include <iostream>
#include <utility>

#include "adapters/program/cli/shell_words.h"

namespace prospect {
namespace {

const ConfigEntry& described(const std::string& key) {
  static const std::vector<ConfigEntry> keys = read_configuration("").entries;
  return *std::find_if(keys.begin(), keys.end(),
                       [&](const ConfigEntry& entry) { return entry.path == key; });
}

bool is_switch(const ConfigEntry& entry) { return entry.range == "true, false"; }
bool is_text(const ConfigEntry& entry) { return entry.range == "text"; }
bool is_list(const ConfigEntry& entry) { return entry.default_value.starts_with("["); }

/// "Of the robot's clock [s], 1 to 1e+06; key mission.time_limit".
std::string help_of(const ConfigEntry& entry) {
  std::string text = entry.description;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  if (!entry.unit.empty() && entry.unit != "1") text += " [" + entry.unit + "]";
  if (entry.words.empty() && !is_text(entry)) text += ", " + entry.range;
  return text + "; key " + entry.path;
}

}  // namespace

std::vector<YamlSetting> ConfigurationArguments::settings() const {
  std::vector<YamlSetting> all = spelled;
  all.insert(all.end(), set.begin(), set.end());
  return all;
}

void tell_notices(std::vector<std::string> notices) {
  for (auto notice = notices.begin(); notice != notices.end(); ++notice) {
    if (std::find(notices.begin(), notice, *notice) != notice) continue;
    std::cerr << "prospect: " << *notice << '\n';
  }
}

Configuration read_told(const ConfigurationArguments& arguments, const Registries& registries,
                        ConfigurationUse use, std::vector<YamlSetting> below) {
  const std::vector<YamlSetting> told = arguments.settings();
  below.insert(below.end(), told.begin(), told.end());
  Configuration configuration = read_configuration(arguments.file, registries, below, use);
  tell_notices(configuration.notices);
  return configuration;
}

PerceptionOptions read_told_perception(const ConfigurationArguments& arguments,
                                       const PerceptionOptions& defaults, ConfigurationUse use) {
  std::vector<std::string> notices;
  PerceptionOptions perception =
      read_perception(arguments.file, arguments.settings(), defaults, use, &notices);
  tell_notices(std::move(notices));
  return perception;
}

void add_set(CLI::App* command, ConfigurationArguments& arguments) {
  command
      ->add_option("--set", arguments.set,
                   "A value above the configuration file and above options for the same key, such "
                   "as planner.weights.w_l=0; ~: the default. May be given several times. Keys: "
                   "`prospect config`")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_configuration(CLI::App* command, ConfigurationArguments& arguments,
                       const std::string& of) {
  command->add_option("--config", arguments.file, "Configuration file (YAML)" + of)
      ->type_name("FILE");
  add_set(command, arguments);
}

CLI::Option* add_key(CLI::App* command, ConfigurationArguments& arguments,
                     const KeyOption& option) {
  const ConfigEntry& entry = described(option.key);
  const std::string help = help_of(entry);
  if (is_switch(entry)) {
    return command->add_flag_callback(
        option.name,
        [&arguments, option] { arguments.spelled.emplace_back(option.key + "=true", option.name); },
        help);
  }
  const auto take = [&arguments, &entry, option](const std::vector<std::string>& words) {
    const std::string value = is_list(entry)   ? "[" + joined(words, ", ") + "]"
                              : is_text(entry) ? yaml_text(words.front())
                                               : words.front();
    arguments.spelled.emplace_back(option.key + "=" + value,
                                   option.name + " " + joined(words, " "));
  };
  return command->add_option_function<std::vector<std::string>>(option.name, take, help)
      ->type_name(entry.words.empty() ? option.type : joined(entry.words, "|"))
      ->expected(option.count)
      ->allow_extra_args(option.count > 1);
}

void add_world_keys(CLI::App* command, ConfigurationArguments& arguments) {
  add_key(command, arguments, {"--start", "world.start", "NUMBER", 3});
  add_key(command, arguments, {"--floor", "world.floor"});
  add_key(command, arguments, {"--resolution", "world.resolution"});
  add_key(command, arguments, {"--unknown", "world.unknown"});
  add_key(command, arguments, {"--up", "world.up"});
  add_key(command, arguments, {"--ground", "world.ground"});
}

}  // namespace prospect
