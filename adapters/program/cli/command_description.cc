// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/command_description.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace prospect {
namespace {

OptionDescription describe_option(const CLI::Option& option) {
  OptionDescription d;
  for (const std::string& name : option.get_snames()) d.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) d.names.push_back("--" + name);
  if (option.get_positional()) d.argument = option.get_name(true, false);
  d.description = option.get_description();
  d.fallback = option.get_default_str();
  d.required = option.get_required();
  const int most = option.get_items_expected_max();
  if (most == 0) return d;
  d.type = option.get_type_name();
  d.list = option.get_delimiter() != '\0';
  d.repeated = option.get_positional() && most > 1;
  // Of a list, and of what may be given several times, one word each time.
  const bool one = d.list || d.repeated || !option.get_allow_extra_args();
  d.values = one ? 1 : std::max(1, option.get_items_expected_min());
  return d;
}

CommandDescription describe_command(const CLI::App& app) {
  CommandDescription d;
  d.name = app.get_name();
  d.description = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->get_positional() ? d.arguments : d.options).push_back(describe_option(*option));
  }
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) d.commands.push_back(describe_command(*command));
  }
  return d;
}

}  // namespace

CommandDescription describe_commands(const CLI::App& app) { return describe_command(app); }

ValueWords words_of(const OptionDescription& option, const TypeWords& types) {
  if (const auto found = types.find(option.type); found != types.end()) return found->second;
  ValueWords value;
  if (option.type.find('|') == std::string::npos) return value;
  for (std::size_t at = 0; at <= option.type.size();) {
    const std::size_t end = std::min(option.type.find('|', at), option.type.size());
    value.words.push_back(option.type.substr(at, end - at));
    at = end + 1;
  }
  return value;
}

}  // namespace prospect
