// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace prospect {

/// Bad input from a person or a file: a missing or corrupt file, an unknown name, a value out of
/// range. Carries every problem that was found, one line each, `file:line: what; expected what`.
/// What a line quotes of a file may hold anything: control characters in it become '?', so that
/// none reaches a terminal. what() is all lines joined by newlines (no newline at the end); the
/// command line prints it and exits with code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& line) : InputError(std::vector<std::string>{line}) {}
  explicit InputError(std::vector<std::string> lines)
      : std::runtime_error(join(printable(lines))), lines_(printable(std::move(lines))) {}

  const std::vector<std::string>& lines() const { return lines_; }

 private:
  static std::vector<std::string> printable(std::vector<std::string> lines) {
    for (std::string& line : lines) {
      for (char& c : line) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
      }
    }
    return lines;
  }
  static std::string join(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
    return text;
  }
  std::vector<std::string> lines_;
};

/// What is wrong with `source`, a file or a key, as an InputError.
[[noreturn]] inline void fail(const std::string& source, const std::string& what) {
  throw InputError(source + ": " + what);
}

}  // namespace prospect
