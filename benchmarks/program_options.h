// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace prospect {

/// What an option of a measuring program may be.
struct OptionRules {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  std::vector<std::string> one_of = {};  ///< of texts: what they may be; empty: anything
  int count = 0;                         ///< of a list: how many it must hold; 0: one or more
  bool commas = false;                   ///< of a list: a comma separates, too
  bool required = false;
};

/// Command line of a measuring program: CLI11 behind a header without it, as a file that includes
/// it takes ten seconds to compile. A name that begins with "--" is an option's, any other that of
/// an argument by place. The variables must live until parse() has returned; they keep their value
/// where nothing is given, and help shows it.
class ProgramOptions {
 public:
  explicit ProgramOptions(const std::string& description);
  ~ProgramOptions();

  void add(const std::string& name, bool& flag, const std::string& help);
  void add(const std::string& name, int& value, const std::string& help,
           const OptionRules& rules = {});
  void add(const std::string& name, double& value, const std::string& help,
           const OptionRules& rules = {});
  void add(const std::string& name, std::string& value, const std::string& help,
           const OptionRules& rules = {});
  void add(const std::string& name, std::vector<std::string>& values, const std::string& help,
           const OptionRules& rules = {});
  void add(const std::string& name, std::vector<double>& values, const std::string& help,
           const OptionRules& rules = {});

  /// The code with which the program is to end, 0 after help and 2 after one line that says what is
  /// wrong; nothing if it is to go on.
  std::optional<int> parse(int argc, char** argv);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace prospect
