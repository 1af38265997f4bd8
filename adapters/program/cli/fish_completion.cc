// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "adapters/program/cli/shell_completion.h"
#include "adapters/program/cli/shell_words.h"

namespace prospect {
namespace {

/// Between single quotes, as fish reads them.
std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string fish_value(const OptionDescription& option, const TypeWords& types) {
  const ValueWords value = words_of(option, types);
  std::string text;
  if (!value.words.empty()) {
    const std::string words = fish_quoted(joined(value.words, " "));
    // What stands between the quotes of -a is read a second time.
    text = option.list
               ? " -a " + fish_quoted("(__fish_complete_list , \"string split ' ' " + words + "\")")
               : " -a " + words;
  }
  if (value.files) return " -F" + text;
  if (value.folders) return " -f" + text + " -a '(__fish_complete_directories)'";
  return " -f" + text;
}

std::string fish_option(const std::string& condition, const OptionDescription& option,
                        const TypeWords& types) {
  std::string text = "complete -c prospect -n " + fish_quoted(condition);
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (option.values > 0) text += " -r" + fish_value(option, types);
  return text + " -d " + fish_quoted(option.description) + "\n";
}

}  // namespace

std::string fish_completion(const CommandDescription& program, const TypeWords& types) {
  std::string text = "# Completion of prospect in fish, ";
  text += kWrittenByTheBuild;
  text +=
      "function __prospect_runs\n"
      "    set -l words (commandline -opc) none\n"
      "    test \"$words[2]\" = $argv[1]\n"
      "end\n"
      "complete -c prospect -f\n";
  for (const OptionDescription& option : program.options) {
    text += fish_option("__prospect_runs none", option, types);
  }
  for (const CommandDescription& command : program.commands) {
    const std::string within = "__prospect_runs " + command.name;
    text += "complete -c prospect -n '__prospect_runs none' -a " + command.name + " -d " +
            fish_quoted(command.description) + "\n";
    for (const OptionDescription& argument : command.arguments) {
      if (words_of(argument, types).empty()) continue;
      text += "complete -c prospect -n " + fish_quoted(within) + fish_value(argument, types) + "\n";
    }
    for (const OptionDescription& option : command.options) {
      text += fish_option(within, option, types);
    }
  }
  return text;
}

}  // namespace prospect
