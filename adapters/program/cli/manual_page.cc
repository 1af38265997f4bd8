// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/manual_page.h"

#include <cctype>

#include "models/version.h"

namespace prospect {
namespace {

/// As roff prints it: dashes as typed, nothing taken for a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if (c == '\'') {
      out += "\\(aq";
    } else if (c == '`') {
      out += "\\(ga";
    } else {
      out += c;
    }
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string bold(const std::string& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// With a full stop at the end.
std::string sentence(const std::string& text) {
  return roff(text) + (text.empty() || text.ends_with('.') ? "" : ".");
}

std::string head(const std::string& name, const std::string& description) {
  std::string summary = description.substr(0, description.find_last_not_of('.') + 1);
  // Names are not broken at the end of a line.
  return ".TH " + upper(roff(name)) + " 1 \"\" \"prospect " + kVersion + "\" \"User Commands\"\n" +
         ".nh\n.ad l\n.SH NAME\n" + roff(name) + " \\- " + roff(summary) + "\n";
}

std::string item(const OptionDescription& option) {
  std::string text = ".TP\n";
  if (!option.argument.empty()) text += italic(option.argument);
  for (std::size_t k = 0; k < option.names.size(); ++k) {
    text += (k > 0 ? ", " : "") + bold(option.names[k]);
  }
  if (option.argument.empty()) {
    for (int k = 0; k < option.values; ++k) text += ' ' + italic(option.type);
    if (option.list) text += "[,...]";
  }
  text += '\n' + sentence(option.description);
  if (!option.fallback.empty()) text += " Default: " + roff(option.fallback) + '.';
  return text + '\n';
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n"
    ".TP\n0\nDone.\n"
    ".TP\n1\nFailed, and the messages say why: the task was not done, or no back end found a "
    "feasible solution.\n"
    ".TP\n2\nBad input. One line for each problem on standard error.\n"
    ".TP\n3\nA back end or another part is not built in.\n"
    ".TP\n4\nA signal, such as Ctrl-C, ended it before all was done. What it has written is "
    "whole.\n";

}  // namespace

std::string manual_page(const CommandDescription& program) {
  const std::string& name = program.name;
  std::string page = head(name, program.description);
  page += ".SH SYNOPSIS\n" + bold(name) + " " + italic("command") + " [" + italic("argument") +
          " ...]\n";
  page += ".SH DESCRIPTION\n" + sentence(program.description) + "\n";
  page += ".SH COMMANDS\n";
  std::string also;
  for (const CommandDescription& command : program.commands) {
    page += ".TP\n" + bold(command.name) + '\n' + sentence(command.description) + '\n';
    also += (also.empty() ? "" : ",\n") + bold(name + "-" + command.name) + "(1)";
  }
  page += ".SH OPTIONS\n";
  for (const OptionDescription& option : program.options) page += item(option);
  return page + kExitStatus + ".SH SEE ALSO\n" + also + '\n';
}

std::string manual_page(const CommandDescription& program, const CommandDescription& command) {
  const std::string name = program.name + "-" + command.name;
  std::string page = head(name, command.description);
  page +=
      ".SH SYNOPSIS\n" + bold(program.name + " " + command.name) + " [" + italic("options") + "]";
  for (const OptionDescription& argument : command.arguments) {
    const std::string word = italic(argument.argument) + (argument.repeated ? " ..." : "");
    page += argument.required ? ' ' + word : " [" + word + ']';
  }
  page += "\n.SH DESCRIPTION\n" + sentence(command.description) + "\n";
  if (!command.arguments.empty()) page += ".SH ARGUMENTS\n";
  for (const OptionDescription& argument : command.arguments) page += item(argument);
  page += ".SH OPTIONS\n";
  for (const OptionDescription& option : command.options) page += item(option);
  return page + kExitStatus + ".SH SEE ALSO\n" + bold(program.name) + "(1)\n";
}

}  // namespace prospect
