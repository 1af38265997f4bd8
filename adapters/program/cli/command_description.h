// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace prospect {

/// What the program takes, read off the definitions that parse it, for completions and manual
/// pages.
struct OptionDescription {
  std::vector<std::string> names;  ///< "--seed"; with a dash or two; none of an argument
  std::string argument;            ///< "world"; "" of an option
  std::string type;         ///< of a value: "FILE", "model|camera" (the choices); "" of a switch
  std::string description;  ///< one line
  std::string fallback;     ///< "" if the definition names none
  int values = 0;           ///< words that follow; 0 of a switch
  bool list = false;        ///< several values in one word, with commas between them
  bool required = false;    ///< of an argument
  bool repeated = false;    ///< of an argument: there may be several
};

struct CommandDescription {
  std::string name;  ///< "explore"; of the program "prospect"
  std::string description;
  std::vector<OptionDescription> arguments, options;
  std::vector<CommandDescription> commands;
};

/// Of the program, without hidden commands and options.
CommandDescription describe_commands(const CLI::App& app);

/// What a value may be.
struct ValueWords {
  std::vector<std::string> words;  ///< names there are
  bool files = false;              ///< or the path of a file
  bool folders = false;            ///< or of a folder

  bool empty() const { return words.empty() && !files && !folders; }
  bool operator==(const ValueWords&) const = default;
};

/// By OptionDescription::type, such as "WORLD".
using TypeWords = std::map<std::string, ValueWords>;

/// What values of this type may be: its choices, or what `types` says; empty: no more is known than
/// that it is a number or a text.
ValueWords words_of(const OptionDescription& option, const TypeWords& types);

}  // namespace prospect
