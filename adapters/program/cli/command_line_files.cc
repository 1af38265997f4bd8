// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/command_line_files.h"

#include <filesystem>
#include <system_error>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/whole_file.h"
#include "adapters/formats/worlds/builtin_worlds.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/program/cli/command_description.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/manual_page.h"
#include "adapters/program/cli/shell_completion.h"
#include "solvers/registry.h"

namespace prospect {
namespace {

TypeWords type_words() {
  ValueWords solvers, keys;
  for (const SolverInfo& solver : list_solvers()) solvers.words.push_back(solver.name);
  for (const ConfigEntry& entry : read_configuration("").entries) {
    keys.words.push_back(entry.path + "=");
  }
  std::vector<std::string> problems;
  for (const std::string& world : builtin_world_names()) problems.push_back(world + "@");
  return {{"FILE", {{}, true, false}},
          {"DIR", {{}, false, true}},
          {"WORLD", {builtin_world_names(), true, false}},
          {"PROBLEM", {problems, true, false}},
          {"SET", {builtin_set_names(), true, false}},
          {"SOLVER", solvers},
          {"KEY=VALUE", keys}};
}

}  // namespace

int write_command_line_files(const CLI::App& app, const std::string& folder) {
  namespace fs = std::filesystem;
  const auto write = [&](const std::string& name, const std::string& text) {
    const fs::path path = fs::path(folder) / name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const std::string wrong = error ? error.message() : write_whole_file(path.string(), text);
    if (!wrong.empty()) {
      throw InputError(path.string() + ": cannot be written (" + wrong +
                       "); expected a folder to write to");
    }
  };
  const CommandDescription program = describe_commands(app);
  const TypeWords types = type_words();
  write("bash-completion/completions/prospect", bash_completion(program, types));
  write("zsh/site-functions/_prospect", zsh_completion(program, types));
  write("fish/vendor_completions.d/prospect.fish", fish_completion(program, types));
  write("man/man1/prospect.1", manual_page(program));
  for (const CommandDescription& command : program.commands) {
    write("man/man1/prospect-" + command.name + ".1", manual_page(program, command));
  }
  return kDone;
}

}  // namespace prospect
