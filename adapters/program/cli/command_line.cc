// SPDX-License-Identifier: Apache-2.0
#include "adapters/program/cli/command_line.h"

#include <fcntl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/files/not_built_in.h"
#include "adapters/missions/bench/problem_set.h"
#include "adapters/program/cli/build_info.h"
#include "adapters/program/cli/command_line_files.h"
#include "adapters/program/cli/commands.h"
#include "adapters/program/cli/common_options.h"
#include "adapters/program/cli/interrupt.h"
#include "adapters/program/cli/parse_command_line.h"
#include "adapters/program/cli/shell_words.h"
#include "adapters/robots/user/load_robot.h"
#include "adapters/robots/user/return_deadline.h"

namespace {

/// One `prospect: ` line a problem, on stderr.
int refuse(const std::vector<std::string>& lines, int code) {
  for (std::string line : lines) {
    for (char& c : line) {
      if (c == '\n' || c == '\r') c = ' ';  // a file's name may hold one
    }
    std::cerr << "prospect: " << line << '\n';
  }
  return code;
}

/// A file that is opened must not become what was closed as standard output or error; one that
/// grows beyond its limit (ulimit -f) is a write that fails, as on a full disk, and no signal.
void open_standard_files() {
  std::signal(SIGXFSZ, SIG_IGN);
  for (int file = 0; file >= 0 && file <= 2;) file = open("/dev/null", O_RDWR);
}

/// The code, but for output that was not taken: one line, and kFailed where all else was done.
int checked_output(int code) {
  errno = 0;
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (written) return code;
  const std::string reason = errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : "";
  refuse({"standard output: cannot be written" + reason + "; expected room for it"}, code);
  return code == prospect::kDone ? static_cast<int>(prospect::kFailed) : code;
}

int run(int argc, char** argv, const prospect::LoadPlugin& load,
        const std::vector<std::string>& program, prospect::SignalGuard& signals) {
  using namespace prospect;
  CLI::App app{"Plans for robots that explore by sight.", "prospect"};
  app.require_subcommand(0, 1);
  bool version = false, version_json = false;
  CLI::Option* version_flag = app.add_flag(
      "--version", version, "The version, its commit, compiler and libraries, and exit");
  app.add_flag("--json", version_json, "With --version: as JSON")->needs(version_flag);

  std::vector<Command> commands;
  for (const auto add :
       {explore_command, drive_command, relay_command, report_command, export_command,
        solve_command, bench_command, replay_command, study_command, reproduce_command,
        inspect_command, odometry_command, map_command, list_command, config_command}) {
    commands.push_back(add(app));
  }
  std::vector<std::string> plugins;
  for (const Command& command : commands) {
    add_plugins(command.options, plugins);
  }

  // For the build: completions and manual pages.
  std::string shared_folder;
  CLI::App* files_command = app.add_subcommand("command-line-files")->group("");
  files_command->add_option("folder", shared_folder)->required();

  try {
    parse_command_line(app, argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  }
  if (version) {
    const BuildInfo info = build_info();
    std::cout << (version_json ? to_json(info).dump(2) + '\n' : to_text(info));
    return kDone;
  }
  if (app.get_subcommands().empty()) {
    std::cout << app.help();
    return kDone;
  }
  if (*files_command) return write_command_line_files(app, shared_folder);
  Registries registries;
  load_plugins(plugins, load, registries);
  const Invocation invocation{registries, typed_line(argc, argv), plugins, program, signals, load};
  const auto chosen = std::find_if(commands.begin(), commands.end(), [](const Command& command) {
    return command.options->parsed();
  });
  return chosen->run(invocation);
}

}  // namespace

std::string prospect::typed_line(int argc, const char* const* argv) {
  std::string line;
  bool token = false;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    constexpr std::string_view kOption = "--live-token";
    const bool holds = word.starts_with(std::string(kOption) + "=");
    line += i > 0 ? " " : "";
    line += token ? "..." : holds ? std::string(kOption) + "=..." : shell_word(word);
    token = word == kOption;
  }
  return line;
}

void prospect::load_plugins(const std::vector<std::string>& plugins, const LoadPlugin& load,
                            Registries& registries, double patience) {
  for (const std::string& name : builtin_set_names()) registries.problems.reserve(name);
  for (const std::string& path : plugins) {
    const PluginRobot* robot = nullptr;
    const ReturnDeadline deadline("plug-in '" + path + "': its entry", patience);
    const std::string warning =
        load(path, {registries.solvers, registries.terms, registries.problems, &robot});
    if (!warning.empty()) std::cerr << "prospect: " << warning << '\n';
    if (robot) {
      UserRobot loaded = load_robot(*robot, path);
      registries.robots.push_back(
          {path, robot->description ? robot->description : "", std::move(loaded)});
    }
  }
}

int prospect::reported(const std::function<int(SignalGuard&)>& program) {
  open_standard_files();
  SignalGuard signals;
  try {
    return checked_output(program(signals));
  } catch (const InputError& error) {
    return refuse(error.lines(), kBadInput);
  } catch (const std::invalid_argument& error) {
    return refuse({error.what()}, kBadInput);
  } catch (const NotBuiltIn& error) {
    return refuse({error.what()}, kNotBuiltIn);
  } catch (const std::exception& error) {
    return refuse({error.what()}, kFailed);
  }
}

int prospect::run_command_line(int argc, char** argv, const LoadPlugin& load,
                               const std::vector<std::string>& program) {
  return reported([&](SignalGuard& signals) { return run(argc, argv, load, program, signals); });
}
