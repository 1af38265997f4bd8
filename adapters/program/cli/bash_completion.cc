// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adapters/program/cli/shell_completion.h"
#include "adapters/program/cli/shell_words.h"

namespace prospect {
namespace {

// Its functions set pending, words, files, folders and list of the function that calls them.
constexpr const char* kBash = R"bash(
_prospect() {
  local word command= option= arguments=0 pending=0 i
  local -a line=()
  # Bash splits words at : and =, as in nlopt:LD_SLSQP and --seed=3; here they are whole.
  for ((i = 0; i <= COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if ((i > 1)) && [[ $word == [:=]* || ${COMP_WORDS[i - 1]} == [:=] ]]; then
      line[-1]+=$word
    else
      line+=("$word")
    fi
  done
  local cur=${line[-1]}
  unset 'line[-1]'
  for word in "${line[@]:1}"; do
    if ((pending > 0)); then
      pending=$((pending - 1))
    elif [[ $word == -* ]]; then
      option=$word
      _prospect_count "$command $option"
    elif [[ -z $command ]]; then
      command=$word
    else
      arguments=$((arguments + 1))
    fi
  done

  local words= files= folders= list= prefix=
  if ((pending > 0)) && [[ $cur != --* ]]; then
    _prospect_value "$command $option"
  elif [[ $cur == --*=* ]]; then
    _prospect_value "$command ${cur%%=*}"
    cur=${cur#*=}
  elif [[ $cur == -* ]]; then
    _prospect_options "$command"
  elif [[ -z $command ]]; then
    words=$_prospect_commands
  else
    _prospect_value "$command @$((arguments + 1))"
  fi
  [[ -z $list ]] || prefix=${cur%"${cur##*,}"}
  COMPREPLY=()
  while IFS= read -r word; do
    COMPREPLY+=("$word")
  done < <(
    compgen -P "$prefix" -W "$words" -- "${cur#"$prefix"}"
    [[ -z $files ]] || compgen -f -- "$cur"
    [[ -z $folders ]] || compgen -d -- "$cur"
  )
  [[ -z $files$folders ]] || compopt -o filenames 2>/dev/null
  # What follows a key or a world's name belongs to the same word.
  [[ ${COMPREPLY[0]-} != *[=@] ]] || compopt -o nospace 2>/dev/null
  # Bash puts in only what follows the last : or =.
  if [[ $cur == *[:=]* ]]; then
    prefix=${cur%"${cur##*[:=]}"}
    COMPREPLY=("${COMPREPLY[@]#"$prefix"}")
  fi
}
complete -F _prospect prospect
)bash";

/// Cases of a `case` by what they do: those that do the same are one.
class BashCases {
 public:
  void add(const std::string& pattern, const std::string& body) {
    for (auto& [known, patterns] : cases_) {
      if (known != body) continue;
      patterns.push_back(pattern);
      return;
    }
    cases_.emplace_back(body, std::vector<std::string>{pattern});
  }
  std::string function(const std::string& name) const {
    std::string text = name + "() {\n  case $1 in\n";
    for (const auto& [body, patterns] : cases_) {
      text += "    " + joined(patterns, " | ") + ") " + body + ";;\n";
    }
    return text + "  esac\n}\n";
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> cases_;
};

}  // namespace

std::string bash_completion(const CommandDescription& program, const TypeWords& types) {
  BashCases options, counts, values;
  const auto add_value = [&](const std::string& pattern, const OptionDescription& option) {
    const ValueWords value = words_of(option, types);
    if (value.empty()) return;
    std::string body;
    if (!value.words.empty()) body += "words=" + shell_quoted(joined(value.words, " ")) + ' ';
    if (value.files) body += "files=1 ";
    if (value.folders) body += "folders=1 ";
    if (option.list) body += "list=1 ";
    values.add(pattern, body);
  };
  const auto add_command = [&](const std::string& command, const CommandDescription& of) {
    std::vector<std::string> names;
    for (const OptionDescription& option : of.options) {
      for (const std::string& name : option.names) {
        names.push_back(name);
        const std::string pattern = shell_quoted(command + ' ' + name);
        if (option.values > 0) {
          counts.add(pattern, "pending=" + std::to_string(option.values) + ' ');
        }
        add_value(pattern, option);
      }
    }
    options.add(shell_quoted(command), "words=" + shell_quoted(joined(names, " ")) + ' ');
    for (std::size_t k = 0; k < of.arguments.size(); ++k) {
      const bool all = of.arguments[k].repeated;
      add_value(
          shell_quoted(command + " @" + (all ? "" : std::to_string(k + 1))) + (all ? "*" : ""),
          of.arguments[k]);
    }
  };
  add_command("", program);
  std::vector<std::string> commands;
  for (const CommandDescription& command : program.commands) {
    commands.push_back(command.name);
    add_command(command.name, command);
  }
  return "# Completion of prospect in bash, " + std::string(kWrittenByTheBuild) +
         "_prospect_commands=" + shell_quoted(joined(commands, " ")) + "\n\n" +
         "# Options of a command.\n" + options.function("_prospect_options") +
         "\n# How many words follow an option.\n" + counts.function("_prospect_count") +
         "\n# What a value may be, of an option or of an argument (@1, @2).\n" +
         values.function("_prospect_value") + kBash;
}

}  // namespace prospect
