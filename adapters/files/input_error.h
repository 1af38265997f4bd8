#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace prospect {

/// Bad input from a person or a file: a missing or corrupt file, an unknown name, a value out of
/// range. Carries every problem that was found, one line each, `file:line: what; expected what`.
/// what() is all lines joined by newlines (no newline at the end); the command line prints it and
/// exits with code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& line) : InputError(std::vector<std::string>{line}) {}
  explicit InputError(std::vector<std::string> lines)
      : std::runtime_error(join(lines)), lines_(std::move(lines)) {}

  const std::vector<std::string>& lines() const { return lines_; }

 private:
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
