// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/parse_command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "models/nearest_name.h"

namespace prospect {
namespace {

/// As a shell calls it: "prospect explore".
std::string call_of(const CLI::App& app, const CLI::App* command) {
  return app.get_name() + (command == nullptr ? "" : " " + command->get_name());
}

[[noreturn]] void refuse_command(const CLI::App& app, const std::string& name) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) commands.push_back(command->get_name());
  }
  throw InputError("unknown command '" + name + "'" + did_you_mean(name, commands) +
                   expected_one_of(commands));
}

[[noreturn]] void refuse_option(const CLI::App& of, const std::string& call,
                                const std::string& given) {
  const std::string option = given.substr(0, given.find('='));
  std::vector<std::string> known;
  for (const CLI::Option* o : of.get_options()) {
    for (const std::string& name : o->get_lnames()) known.push_back(name);
  }
  const std::size_t dashes = option.find_first_not_of('-');
  const std::string nearest =
      dashes == std::string::npos ? "" : nearest_name(option.substr(dashes), known);
  if (!nearest.empty()) {
    throw InputError("unknown option " + option + "; did you mean --" + nearest + "?");
  }
  for (std::string& name : known) name.insert(0, "--");
  throw InputError("unknown option " + option + " of `" + call + "`" + expected_one_of(known));
}

/// "--seed: 1 required UINT missing" as what the user left out.
std::string in_words(const CLI::ParseError& error) {
  const std::string text = error.what();
  const std::string required = " required ", missing = " missing";
  const std::size_t colon = text.find(": "), at = text.find(required);
  const bool typed = colon != std::string::npos && at != std::string::npos &&
                     text.size() > missing.size() && text.ends_with(missing);
  if (!typed) return text;
  const std::string count = text.substr(colon + 2, at - colon - 2);
  const std::size_t type = at + required.size();
  return text.substr(0, colon) + ": no value; expected " + (count == "1" ? "" : count + " ") +
         text.substr(type, text.size() - missing.size() - type);
}

/// CLI11 takes the next option for the value of one that has none: `--out --quiet`.
void refuse_options_as_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_positional() || option->get_items_expected_max() == 0) continue;
    const std::string type = option->get_type_name();
    option->check(CLI::Validator(
        [type](std::string& text) {
          return text.starts_with("--") ? "no value before " + text + "; expected " + type
                                        : std::string();
        },
        ""));
  }
}

}  // namespace

void parse_command_line(CLI::App& app, int argc, const char* const* argv) {
  if (argc > 1 && argv[1][0] != '-') {
    const auto commands = app.get_subcommands({});
    const bool known = std::any_of(commands.begin(), commands.end(), [&](const CLI::App* command) {
      return command->get_name() == argv[1];
    });
    if (!known) refuse_command(app, argv[1]);
  }
  for (CLI::App* command : app.get_subcommands({})) refuse_options_as_values(*command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ParseError& error) {
    const std::vector<CLI::App*> parsed = app.get_subcommands();
    const CLI::App* command = parsed.empty() ? nullptr : parsed.front();
    const std::string call = call_of(app, command);
    // First: what follows an unknown option is taken for something else, which may be wrong as
    // well.
    for (const std::string& left : app.remaining(true)) {
      if (left.size() > 1 && left[0] == '-') {
        refuse_option(command == nullptr ? app : *command, call, left);
      }
    }
    std::string what = in_words(error);
    if (const std::vector<std::string> left = app.remaining(true); !left.empty()) {
      what = "unexpected argument '" + left.front() + "'";
    }
    throw InputError(what + "; see `" + call + " --help`");
  }
}

}  // namespace prospect
