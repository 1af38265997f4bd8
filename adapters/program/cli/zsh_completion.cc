// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include "adapters/program/cli/shell_completion.h"
#include "adapters/program/cli/shell_words.h"

namespace prospect {
namespace {

/// Within the brackets of a specification of _arguments.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

/// Functions that complete values, by what they complete.
class ZshValues {
 public:
  /// ":FILE:_files", with a function of its own where no simple action does; ":NUMBER: " where
  /// nothing is known.
  std::string specification(const OptionDescription& option, const TypeWords& types) {
    const ValueWords value = words_of(option, types);
    const std::string type = option.type.find('|') == std::string::npos ? option.type
                             : option.names.empty()                     ? option.argument
                                                    : option.names.back().substr(2);
    std::string text = ":";
    text += zsh_escaped(type);
    text += ":";
    return text += action(value, option.list);
  }
  const std::string& functions() const { return functions_; }

 private:
  std::string action(const ValueWords& value, bool list) {
    if (value.empty()) return " ";
    if (value.words.empty()) return value.files ? "_files" : "_files -/";
    for (const auto& [known, of_list, name] : known_) {
      if (known == value && of_list == list) return name;
    }
    const std::string name = "_prospect_values_" + std::to_string(known_.size() + 1);
    known_.emplace_back(value, list, name);
    functions_ += name + "() {\n  local -a words=(";
    std::size_t column = 0;
    for (const std::string& word : value.words) {
      const std::string next = shell_quoted(word);
      const bool wrap = column + next.size() > 90;
      functions_ += (wrap ? "\n    " : column > 0 ? " " : "") + next;
      column = (wrap ? 4 : column + 1) + next.size();
    }
    functions_ += ")\n";
    // What follows a key or a world's name belongs to the same word.
    const char last = value.words.front().back();
    const std::string add =
        last == '=' || last == '@' ? "compadd -S \"\" -a words" : "compadd -a words";
    if (list) {
      functions_ += "  _sequence compadd - -a words\n";
    } else if (value.files || value.folders) {
      functions_ += "  _alternative 'names:name:" + add + "' 'files:file:_files";
      functions_ += value.files ? "'\n" : " -/'\n";
    } else {
      functions_ += "  " + add + '\n';
    }
    functions_ += "}\n";
    return name;
  }

  std::vector<std::tuple<ValueWords, bool, std::string>> known_;
  std::string functions_;
};

std::string zsh_option(const OptionDescription& option, const TypeWords& types, ZshValues& values) {
  std::string text;
  for (const std::string& name : option.names) {
    std::string rule = name == "-h" || name == "--help" ? "(- *)" : "*";
    rule += name;
    if (option.values > 0 && name.starts_with("--")) rule += "=";
    rule += '[';
    rule += zsh_escaped(option.description);
    rule += ']';
    for (int k = 0; k < option.values; ++k) rule += values.specification(option, types);
    text += " \\\n        " + shell_quoted(rule);
  }
  return text;
}

}  // namespace

std::string zsh_completion(const CommandDescription& program, const TypeWords& types) {
  ZshValues values;
  std::string commands, cases, own;
  for (const OptionDescription& option : program.options) own += zsh_option(option, types, values);
  for (const CommandDescription& command : program.commands) {
    std::string name = command.name + ":" + command.description;
    commands += "    " + shell_quoted(name) + "\n";
    cases += "    " + command.name + ")\n      _arguments -S";
    for (const OptionDescription& option : command.options) {
      cases += zsh_option(option, types, values);
    }
    for (std::size_t k = 0; k < command.arguments.size(); ++k) {
      const OptionDescription& argument = command.arguments[k];
      const std::string place = argument.repeated ? "*" : std::to_string(k + 1);
      cases += " \\\n        " + shell_quoted(place + values.specification(argument, types));
    }
    cases += "\n      ;;\n";
  }
  std::string text = "#compdef prospect\n# Completion of prospect in zsh, ";
  text += kWrittenByTheBuild;
  text += values.functions();
  text += "\n_prospect() {\n  local curcontext=$curcontext state line\n  local -a commands=(\n" +
          commands + "  )\n  _arguments -C" + own +
          " \\\n        '1: :->command' \\\n        '*:: :->argument'\n"
          "  case $state in\n"
          "  command) _describe command commands ;;\n"
          "  argument)\n    case $line[1] in\n" +
          cases + "    esac\n    ;;\n  esac\n}\n\n";
  return text + "_prospect \"$@\"\n";
}

}  // namespace prospect
